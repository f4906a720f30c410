"""A film made by hand: the small robot moves, stands, is loaded in steps and unloaded again."""

from dataclasses import fields, replace

import mujoco
import numpy as np

from bench.robot.bodies import Array
from bench.robot.compiled import CompiledRobot
from bench.simulate.instruments import Instruments, Reading
from bench.simulate.session import Film
from bench.simulate.trace import Trace

PERIOD = 0.1  # [s]
MOVE, PART = 20, 15  # instants of the move at the beginning, and of each step of the load
FORCES = (0.0, 100.0, 200.0, 100.0, 0.0)  # [N]
COMPLIANCE = 2e-5  # [rad/N], of every joint of the made-up robot
LENGTH = MOVE + PART * len(FORCES)
EVENTS = ((2.0, "pose 1, from below, 0 N"), (3.5, "pose 1, from below, 100 N"))


def made_film(compiled: CompiledRobot, rng: np.random.Generator | None = None) -> Film:
    """Return a film of `LENGTH` instants; perfect instruments without `rng`."""
    n, model, at = compiled.n_joints, compiled.model, compiled.at
    force = np.concatenate([np.zeros(MOVE), np.repeat(FORCES, PART)])
    q = np.full((LENGTH, n), 0.4)
    q[:MOVE] = np.linspace(0.0, 0.4, MOVE)[:, None]
    theta = q + COMPLIANCE * (50.0 + force[:, None])  # 50 N stand for the robot's own weight
    velocity = np.where(np.arange(LENGTH) < MOVE, 0.2, 0.0)[:, None] * np.ones(n)
    data = mujoco.MjData(model)
    reflectors, load_point = np.empty((LENGTH, len(at.reflectors), 3)), np.empty((LENGTH, 3))
    for i in range(LENGTH):
        data.qpos[at.theta], data.qpos[at.q] = theta[i], q[i]
        mujoco.mj_kinematics(model, data)
        reflectors[i], load_point[i] = data.site_xpos[at.reflectors], data.site_xpos[at.load_point]
    wrench = np.zeros((LENGTH, 6))
    wrench[:, 2] = -force
    torque = (1.0 + np.arange(n)) * force[:, None]
    trace = Trace(
        time=PERIOD * np.arange(LENGTH),
        q=q,
        q_velocity=velocity,
        theta=theta,
        theta_velocity=velocity,
        motor_torque=torque,
        motor_friction=0.1 * torque,
        link_friction=-0.1 * torque,
        reflectors=reflectors,
        load_point=load_point,
        wrench=wrench,
        counterbalance_force=np.full(LENGTH, 1.2e4),
        gas_force=np.full(LENGTH, 1.2e4),
        counterbalance_length=np.linspace(0.5, 0.6, LENGTH),
    )
    return Film(trace, Instruments(compiled, rng).read(trace), EVENTS)


def without(film: Film, *quantities: str) -> Film:
    """Return the film with instruments missing: their readings are nan."""
    missing = {name: np.full_like(getattr(film.reading, name), np.nan) for name in quantities}
    return replace(film, reading=replace(film.reading, **missing))


def instants(film: Film, rows: slice) -> Film:
    """Return some instants of a film."""
    reading: dict[str, Array] = {f.name: getattr(film.reading, f.name)[rows] for f in fields(Reading)}
    return Film(film.trace[rows], Reading(**reading), film.events)
