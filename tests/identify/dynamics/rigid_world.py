"""A rigid arm in MuJoCo, moved along Fourier series: data that the identified model's own code did not make."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from scipy import signal

from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.regressor import standard_parameters
from bench.record.campaign import Array, Campaign, Run
from bench.robot.bodies import Point, RigidBodies, read_only
from bench.robot.figures import Uncertainty
from bench.robot.nominal_dynamics import NominalDynamics

GRAVITY = (0.0, 0.0, -9.81)
AXES = ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0))
PLACES = ((0.0, 0.0, 0.4), (0.2, 0.0, 0.3), (0.0, 0.05, 0.9))
N = len(AXES)


def arm(mass: Sequence[float] = (60.0, 40.0, 20.0)) -> RigidBodies:
    """Return an upright arm of three hinges: about z, and twice about y."""
    com = np.array([[0.05, 0.02, 0.1], [0.02, -0.03, 0.4], [0.3, 0.01, 0.05]])
    inertia = np.stack([np.diag(m * np.array([0.03, 0.05, 0.04])) for m in mass])
    return RigidBodies(
        names=("base", "shoulder", "elbow"),
        parent=np.array([-1, 0, 1]),
        is_hinge=np.ones(N, dtype=bool),
        position=read_only(PLACES),
        rotation=read_only(np.tile(np.eye(3), (N, 1, 1))),
        axis=read_only(AXES),
        mass=read_only(mass),
        com=read_only(com),
        inertia=read_only(inertia),
        limits=read_only(np.tile([-2.0, 2.0], (N, 1))),
        gravity=read_only(GRAVITY),
        points={"hook": Point(N - 1, read_only([0.7, 0.0, 0.1]), read_only(np.eye(3)))},
    )


def robot(bodies: RigidBodies, payload: float = 0.0, **uncertainty: float) -> NominalDynamics:
    """Return the nominal dynamics of an arm whose friction nobody stated."""
    return NominalDynamics(
        bodies=bodies,
        rotor_inertia=read_only([8.0, 6.0, 3.0]),
        coulomb=read_only(np.zeros(N)),
        viscous=read_only(np.zeros(N)),
        stiffness=read_only(np.full(N, np.inf)),
        torque_constant=read_only(np.full(N, 50.0)),
        stated_constant=read_only(np.full(N, 50.0)),
        gear_ratio=read_only(np.full(N, np.nan)),
        torque_gain_sigma=read_only(np.zeros(N)),
        torque_offset_sigma=read_only(np.full(N, 1.0)),
        speed_limit=read_only(np.full(N, 2.0)),
        load_point="hook",
        payload=payload,
        payload_sigma=payload,
        payload_side=0.7,
        counterbalance=None,
        gas_amount=0.0,
        uncertainty=Uncertainty.model_validate(uncertainty),
    )


@dataclass(frozen=True)
class Friction:
    """Friction and offset of each drive; torque [Nm], over speed [rad/s]."""

    coulomb: Array
    viscous: Array
    offset: Array

    def torque(self, velocity: Array) -> Array:
        return self.coulomb * np.sign(velocity) + self.viscous * velocity + self.offset


def torque_of(nominal: NominalDynamics, q: Array, velocity: Array, acceleration: Array) -> Array:
    """Return the motor torque without friction, shape (T, n), by MuJoCo's inverse dynamics."""
    model = mujoco.MjModel.from_xml_string(mjcf(nominal))
    data, found = mujoco.MjData(model), np.empty_like(q)
    for i in range(len(q)):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[i], velocity[i], acceleration[i]
        mujoco.mj_inverse(model, data)
        found[i] = data.qfrc_inverse
    return found


def mjcf(nominal: NominalDynamics) -> str:
    """Return a serial arm as MJCF."""
    bodies, text = nominal.bodies, ""
    for i in reversed(range(bodies.n_joints)):
        full = bodies.inertia[i]
        entries = " ".join(f"{full[a, b]:.17g}" for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
        text = (
            f'<body pos="{_row(bodies.position[i])}"><joint axis="{_row(bodies.axis[i])}" '
            f'armature="{nominal.rotor_inertia[i]:.17g}"/><inertial mass="{bodies.mass[i]:.17g}" '
            f'pos="{_row(bodies.com[i])}" fullinertia="{entries}"/>{text}</body>'
        )
    option = f'<option gravity="{_row(bodies.gravity)}"/>'
    return f'<mujoco><compiler angle="radian" balanceinertia="false"/>{option}<worldbody>{text}</worldbody></mujoco>'


def fourier(
    rng: np.random.Generator, seconds: float = 20.0, rate: float = 200.0, base_hz: float = 0.1, n: int = N
) -> tuple[Array, Array, Array, Array]:
    """Return time and an excitation trajectory of five harmonics: position, velocity, acceleration, each (T, n)."""
    time = np.arange(0, seconds, 1 / rate)
    order = np.arange(1, 6)
    w = 2 * np.pi * base_hz * order
    a, b = rng.uniform(-0.35, 0.35, (2, 5, n)) / order[:, None]
    phase = time[:, None] * w
    sine, cosine = np.sin(phase), np.cos(phase)
    q = sine @ a + cosine @ b
    velocity = (cosine * w) @ a - (sine * w) @ b
    return time, q, velocity, -(sine * w**2) @ a - (cosine * w**2) @ b


def coloured(rng: np.random.Generator, shape: tuple[int, int], sigma: float, remembers: float, rate: float) -> Array:
    """Return noise of a standard deviation that remembers for some seconds."""
    pole = np.exp(-1 / (remembers * rate))
    white = rng.standard_normal((shape[0] + 1000, shape[1])) * sigma * np.sqrt(1 - pole**2)
    return np.asarray(signal.lfilter([1.0], [1.0, -pole], white, axis=0)[1000:])


def recorded(
    nominal: NominalDynamics,
    friction: Friction,
    rng: np.random.Generator,
    runs: int = 3,
    sigma: float = 2.0,
    late: float = 0.0,
    **motion: float,
) -> Campaign:
    """Return a campaign: `runs` excitation trajectories of a true arm, torques with coloured noise, read `late` [s]."""
    found = []
    for k in range(runs):
        time, q, velocity, acceleration = fourier(rng, **motion)
        clean = torque_of(nominal, q, velocity, acceleration) + friction.torque(velocity)
        if late:
            clean = np.stack([np.interp(time - late, time, column) for column in clean.T], axis=1)
        found.append(run_of(f"run{k}", 100.0 * k, time, q, clean, sigma, rng))
    return Campaign("rigid", tuple(found))


def run_of(
    name: str, start_s: float, time: Array, q: Array, torque: Array, sigma: float, rng: np.random.Generator
) -> Run:
    """Return a run with coloured noise on the torque."""
    torque = torque + coloured(rng, torque.shape, sigma, 0.1, 1 / (time[1] - time[0]))
    columns = {"time_s": time}
    columns |= {f"q_motor_{j + 1}_rad": q[:, j] for j in range(q.shape[1])}
    columns |= {f"tau_motor_{j + 1}_nm": torque[:, j] for j in range(q.shape[1])}
    return Run(name, "motion", start_s, columns)


def drawn(nominal: NominalDynamics, rng: np.random.Generator) -> NominalDynamics:
    """Return a true arm: masses and centres off by what `uncertainty` says, rotors too."""
    u, bodies = nominal.uncertainty, nominal.bodies
    scale = 1 + u.mass * rng.standard_normal(N)
    return replace(
        nominal,
        rotor_inertia=read_only(nominal.rotor_inertia * (1 + u.rotor_inertia * rng.standard_normal(N))),
        bodies=replace(
            bodies,
            mass=read_only(bodies.mass * scale),
            com=read_only(bodies.com + u.centre_of_mass_m * rng.standard_normal((N, 3))),
            inertia=read_only(bodies.inertia * scale[:, None, None]),
        ),
    )


def truth_of(found: FirstPass, true: NominalDynamics, friction: Friction, payload: float) -> Array:
    """Return the true parameters of a first pass, shape (p,)."""
    layout = found.layout
    truth = np.zeros(layout.size)
    truth[layout.links] = standard_parameters(true.bodies)
    if layout.has_payload:
        truth[layout.payload.start] = payload
    for column, values in (
        ("rotor", true.rotor_inertia),
        ("coulomb", friction.coulomb),
        ("viscous", friction.viscous),
        ("offset", friction.offset),
    ):
        truth[layout.of_drives(column)] = values
    return truth


def _row(values: Array) -> str:
    return " ".join(f"{value:.17g}" for value in values)
