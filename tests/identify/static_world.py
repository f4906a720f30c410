"""An independent static world to test the methods in: no Pinocchio, nothing of `bench.identify` but the readings.

Forward kinematics is Eq. (2) multiplied out from Table 1; gravity and load torques are sums of cross products. At
rest, each joint is an elastic element between a motor under its servo and a link, with an elasto-plastic friction
element on either side. Loads are applied in the order of the states, so that friction remembers; balance is solved
exactly for every state, for all series at once.
"""

from dataclasses import dataclass

import numpy as np

from bench.identify.readings import StaticReadings, Systematic
from tests.identify.hh150 import COUNTERBALANCE, POINTS, STIFFNESS, TABLE_1, TORQUE_CONSTANT

GRAVITY = np.array([0.0, 0.0, -9.81])
NOISE = {"current": 0.02, "resolution": 0.01, "tracker": 30e-6, "force": 0.5, "moment": 0.2, "repeats": 10}


@dataclass(frozen=True)
class World:
    """Friction of a world: levels, and what the servo does about it.

    Attributes:
        link_level: Shape (6,) [Nm], Coulomb level after the spring.
        motor_level: Shape (6,) [Nm], Coulomb level before the spring.
        presliding: [Nm/rad], stiffness of a friction element that sticks.
        servo: [Nm/rad], how the motor gives under load; None: integral action brings it back, and where in its friction
            band it then rests is left to chance.
    """

    link_level: np.ndarray
    motor_level: np.ndarray
    presliding: float = 5e7
    servo: float | None = 1e7


@dataclass(frozen=True)
class Ladder:
    """A visit to a pose: angles [rad], direction of the load, forces [N] in order, approach; it starts unloaded."""

    q: np.ndarray
    direction: np.ndarray
    forces: tuple[float, ...]
    approach: int


def frames(theta):
    """Origins and z axes of frames 1 to 6 and the rotation of each; theta shape (..., 6)."""
    shape = theta.shape[:-1]
    rotation, origin = np.broadcast_to(np.eye(3), (*shape, 3, 3)), np.zeros((*shape, 3))
    rotations, origins = [], []
    for i, row in enumerate(TABLE_1):
        angle = theta[..., i] + row.zero
        ca, sa, ct, st = np.cos(row.alpha), np.sin(row.alpha), np.cos(angle), np.sin(angle)
        zero, one = np.zeros_like(ct), np.ones_like(ct)
        turn = np.stack(
            [
                np.stack([ct, -st, zero], -1),
                np.stack([st * ca, ct * ca, -sa * one], -1),
                np.stack([st * sa, ct * sa, ca * one], -1),
            ],
            -2,
        )
        step = np.array([row.a, -sa * row.d, ca * row.d])
        origin = origin + rotation @ step
        rotation = rotation @ turn
        rotations.append(rotation)
        origins.append(origin)
    return np.stack(rotations, -3), np.stack(origins, -2)


def position(theta, point):
    rotation, origin = frames(theta)
    return origin[..., 5, :] + rotation[..., 5, :, :] @ np.array(POINTS[point])


def pushing(theta, wrench):
    """Gamma = J_f^T W - G - M [Nm], shape (..., 6)."""
    rotation, origin = frames(theta)
    axis = rotation[..., 2]
    point = origin[..., 5, :] + rotation[..., 5, :, :] @ np.array(POINTS["load"])
    torque = np.empty(theta.shape)
    centre = [origin[..., i, :] + rotation[..., i, :, :] @ np.array(row.com) for i, row in enumerate(TABLE_1)]
    for j in range(6):
        arm = point - origin[..., j, :]
        moment = np.cross(arm, wrench[..., :3]) + wrench[..., 3:]
        for i in range(j, 6):
            moment = moment + np.cross(centre[i] - origin[..., j, :], TABLE_1[i].mass * GRAVITY)
        torque[..., j] = np.sum(axis[..., j, :] * moment, -1)
    cbs, angle = COUNTERBALANCE, theta[..., 1] - COUNTERBALANCE.dead_centre
    length = np.sqrt(cbs.b**2 + cbs.rho**2 - 2 * cbs.b * cbs.rho * np.cos(angle))
    pull = cbs.gas_constant / (cbs.critical_length - length)
    torque[..., 1] -= pull * cbs.b * cbs.rho * np.sin(angle) / length
    return torque


def settle(world, state, q_command, wrench, rng):
    """Return the next state (motor and link angles, friction on both sides) and motor torque, all (series, 6)."""
    q0, theta0, motor0, link0 = state
    k, kp = STIFFNESS, world.presliding

    def motor(spring):
        if world.servo is None:
            return q_command, motor0
        stuck = (world.servo * q_command + motor0 + kp * q0 - spring) / (world.servo + kp)
        friction = np.clip(motor0 - kp * (stuck - q0), -world.motor_level, world.motor_level)
        return (world.servo * q_command + friction - spring) / world.servo, friction

    def link(spring):
        theta = motor(spring)[0] - spring / k
        return np.clip(link0 - kp * (theta - theta0), -world.link_level, world.link_level), theta

    theta = theta0
    for _ in range(5):  # N dGamma/dtheta is of order 1e-2
        gamma = pushing(theta, wrench)
        low, high = -gamma - world.link_level - 1e-6, -gamma + world.link_level + 1e-6
        for _ in range(45):
            middle = 0.5 * (low + high)
            too_high = gamma + middle + link(middle)[0] > 0
            low, high = np.where(too_high, low, middle), np.where(too_high, middle, high)
        spring = 0.5 * (low + high)
        theta = link(spring)[1]
    q, friction = motor(spring)
    if world.servo is None:
        friction = world.motor_level * rng.uniform(-1, 1, q.shape)
    return (q, theta, friction, link(spring)[0]), spring - friction


def measure(world, ladders, rng, noisy=True, sigma_xi=0.02, reflectors=("reflector_1",)):
    """Return readings of all ladders in a world; systematic errors are drawn once, noise for every state."""
    length = max(len(ladder.forces) for ladder in ladders)
    q = np.array([ladder.q for ladder in ladders])
    direction = np.array([ladder.direction / np.linalg.norm(ladder.direction) for ladder in ladders])
    approach = np.array([[ladder.approach] for ladder in ladders])
    relaxed = rng.uniform(0.7, 1.0, (2, len(ladders), 6))  # how much of the friction of the approach is left
    state = (
        q + 0.0,
        q + pushing(q, np.zeros((len(ladders), 6))) / STIFFNESS,
        -approach * relaxed[0] * world.motor_level,
        -approach * relaxed[1] * world.link_level,
    )
    state = settled_start(world, state, q)
    rows = []
    for step in range(length):
        force = np.array([ladder.forces[step] if step < len(ladder.forces) else np.nan for ladder in ladders])
        wrench = np.concatenate([np.nan_to_num(force)[:, None] * direction, np.zeros((len(ladders), 3))], 1)
        state, torque = settle(world, state, q, wrench, rng)
        for s, ladder in enumerate(ladders):
            if step < len(ladder.forces):
                points = [position(state[1][s], name) for name in reflectors]
                rows.append((s, force[s] == 0, state[0][s], torque[s], points, wrench[s]))
    series, unloaded, q_motor, torque, points, wrench = (np.array(column) for column in zip(*rows, strict=True))
    order = np.argsort(series, kind="stable")
    series, unloaded, q_motor, torque, points, wrench = (
        column[order] for column in (series, unloaded, q_motor, torque, points, wrench)
    )
    vertical = np.abs(direction[:, 2]) > 1 - 1e-9
    systematic = Systematic(np.hypot(sigma_xi, 0.005) * np.ones(6), 0.005, 0.005, 15e-6)
    current = torque / TORQUE_CONSTANT
    if noisy:
        root = np.sqrt(NOISE["repeats"])
        gain = 1 + systematic.torque_gain * rng.standard_normal(6)
        current = current * gain + 0.01 * rng.standard_normal(6)
        reading = NOISE["current"] * rng.standard_normal((NOISE["repeats"], *current.shape)) + current
        current = np.mean(NOISE["resolution"] * np.round(reading / NOISE["resolution"]), 0)
        points = points + NOISE["tracker"] / root * rng.standard_normal(points.shape)
        points[:, 1:] += systematic.placement * rng.standard_normal(points[:, 1:].shape)
        tilt = systematic.force_direction * rng.standard_normal(3)
        slanted = ~vertical[series]
        wrench[slanted, :3] += np.cross(tilt, wrench[slanted, :3])
        wrench = wrench * (1 + systematic.force_gain * rng.standard_normal())
        wrench[:, :3] += NOISE["force"] / root * rng.standard_normal((len(wrench), 3))
        wrench[:, 3:] += NOISE["moment"] / root * rng.standard_normal((len(wrench), 3))
    return StaticReadings(
        series=series,
        is_reference=unloaded,
        q_motor=q_motor,
        current_torque=current * TORQUE_CONSTANT,
        reflectors=points,
        wrench=wrench,
        is_vertical=vertical[series],
        n_repeats=np.full(len(series), NOISE["repeats"]),
        sigma_current_torque=TORQUE_CONSTANT * np.hypot(NOISE["current"], NOISE["resolution"] / np.sqrt(12)),
        sigma_reflector=NOISE["tracker"],
        sigma_wrench=np.array([NOISE["force"]] * 3 + [NOISE["moment"]] * 3),
        reflector_names=tuple(reflectors),
        load_point="load",
        systematic=systematic,
        approach=approach[series, 0],
    )


def settled_start(world, state, q):
    """Return the state that balances the friction of the approach, so that the first reading moves nothing."""
    _, theta, motor, link = state
    for _ in range(8):
        spring = -pushing(theta, np.zeros_like(q)) if theta.ndim == 1 else -pushing(theta, np.zeros((len(theta), 6)))
        spring = spring - link
        q_rest = q if world.servo is None else q + (motor - spring) / world.servo
        theta = q_rest - spring / STIFFNESS
    return q_rest, theta, motor, link
