"""Passes along a line in an independent static world: angles and torques from `static_world`, friction that slides."""

from dataclasses import dataclass, field

import numpy as np

from bench.identify.line_passes import STATES, WAYS, LinePass, LinePasses
from bench.robot.kinematics import place
from bench.robot.line_path import line_path
from tests.identify.hh150 import STIFFNESS, TORQUE_CONSTANT, hh150
from tests.identify.static_world import position, pushing

PLACES = 61
LOAD = np.array([0.0, 0.0, -1500.0, 0.0, 0.0, 0.0])
NEAR = np.deg2rad([0.0, 3.0, 38.0, 0.0, 49.0, 0.0])
TURNING = np.array([False, True, True, False, True, False])


@dataclass(frozen=True)
class LineWorld:
    """What is true on the line.

    Attributes:
        link_level: Shape (6,) [Nm], friction after the spring.
        motor_level: Shape (6,) [Nm], friction before the spring.
        tracker: [m], noise of one coordinate of one reading.
        current: [A], noise of one reading.
        gain: Shape (6,), relative error of the currents.
    """

    link_level: np.ndarray
    motor_level: np.ndarray
    tracker: float = 0.0
    current: float = 0.0
    gain: np.ndarray = field(default_factory=lambda: np.zeros(6))


def path() -> np.ndarray:
    """Motor angles along the line, shape (PLACES, 6) [rad]; joints 2, 3 and 5 turn."""
    bodies = hh150()
    start = position(NEAR, "load")
    rotation = place(bodies, bodies.points["load"], NEAR).rotation
    line = line_path(bodies, bodies.points["load"], start, start + np.array([0.6, 0, 0]), NEAR, rotation)
    return line.at(np.linspace(0, line.length, PLACES))


def passes(world: LineWorld, q: np.ndarray, rng: np.random.Generator | None = None) -> LinePasses:
    """Return the passes: links in equilibrium at every place, readings with white noise."""
    direction = TURNING * np.sign(np.diff(q, axis=0)).mean(axis=0)
    found = {}
    for state in STATES:
        wrench = np.tile(LOAD if state == "loaded" else np.zeros(6), (len(q), 1))
        for way in WAYS:
            turning = direction if way == "out" else -direction
            theta = q
            for _ in range(8):  # each gains two digits
                torque = pushing(theta, wrench) - world.link_level * turning
                theta = q + torque / STIFFNESS
            current = (-torque + world.motor_level * turning) * (1 + world.gain) / TORQUE_CONSTANT
            found[state, way] = _pass(q, current, position(theta, "reflector_1"), wrench, way == "out", world, rng)
    return LinePasses(np.linspace(0, 1, len(q)), found, "reflector_1", "load", np.full(6, 0.02))


def _pass(q, current, seen, wrench, is_out, world, rng):
    if rng is not None:
        current = current + world.current * rng.standard_normal(current.shape)
        seen = seen + world.tracker * rng.standard_normal(seen.shape)
    return LinePass(
        q_cmd=q,
        q_motor=q,
        current_torque=current * TORQUE_CONSTANT,
        reflector=seen,
        wrench=wrench,
        is_out=is_out,
        sigma_current_torque=world.current * TORQUE_CONSTANT,
        sigma_reflector=np.full(3, world.tracker),
    )
