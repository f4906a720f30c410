"""What readings of drives are held against: columns of the arm's torque along a motion, and what they leave."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from bench.identify.arm import Arm
from bench.identify.dynamics.regressor import N_INERTIAL, link_regressor, payload_columns, standard_parameters
from bench.record.campaign import Array
from bench.robot.nominal_dynamics import NominalDynamics

NOT_SHARP = 0.02  # of the top speed, over which the direction of a slow movement is not sharp (assumed)

TINY = np.finfo(float).tiny


@dataclass(frozen=True)
class Motion:
    """Positions and their derivatives, each of shape (T, n)."""

    position: Array
    velocity: Array
    acceleration: Array

    @classmethod
    def along(cls, time: Array, position: Array) -> "Motion":
        """Differentiate by central differences."""
        velocity = np.gradient(position, time, axis=0)
        return cls(position, velocity, np.gradient(velocity, time, axis=0))

    def seen(self, scale: Array, every: int) -> "Motion":
        """Return each so many samples of the motion, each joint scaled or turned."""
        parts = (self.position, self.velocity, self.acceleration)
        return Motion(*(scale * part[::every] for part in parts))


@dataclass(frozen=True, eq=False)
class LinksAlong:
    """What links need along a motion, linear in their inertial parameters; their masses do not enter.

    Attributes:
        motion: T instants of n joints.
        regressor: Shape (T, n, 10 n), of `standard_parameters`.
        payload: Shape (T, n, 10), of a body in the axes of the link that carries it, its frame in the load point.
    """

    motion: Motion
    regressor: Array
    payload: Array

    @classmethod
    def of(cls, nominal: NominalDynamics, motion: Motion) -> "LinksAlong":
        """Return what links of an arm need along a motion."""
        arm = Arm(nominal.bodies)
        regressor = link_regressor(arm, motion.position, motion.velocity, motion.acceleration)
        carrier, moved = payload_columns(arm, nominal.load_point)
        own = regressor[:, :, N_INERTIAL * carrier : N_INERTIAL * (carrier + 1)]
        return cls(motion, regressor, own @ moved)


def model_columns(nominal: NominalDynamics, along: LinksAlong) -> Array:
    """Return for each drive model torque, speed, direction, one, and the torque of 1 kg of payload, shape (n, T, c).

    Where nobody knows some of the rotors, acceleration stands before the payload, zero for drives whose rotor is known;
    c is 5 or 6.

    Args:
        nominal: The robot, with the joints and the load point of `along`.
        along: Its motion.
    """
    motion = along.motion
    links, payload = along.regressor @ standard_parameters(nominal.bodies), along.payload[:, :, 0]
    unknown = nominal.drive_uncertainty.rotor_is_unknown
    torque = links + np.where(unknown, 0.0, nominal.rotor_inertia) * motion.acceleration
    of_unknown = [np.where(unknown, motion.acceleration, 0.0)] if np.any(unknown) else []
    slow = NOT_SHARP * np.max(np.abs(motion.velocity), axis=0, initial=1e-9)
    direction = np.tanh(motion.velocity / slow)
    stack = np.stack([torque, motion.velocity, direction, np.ones_like(torque), *of_unknown, payload], axis=-1)
    return np.swapaxes(stack, 0, 1)


def solved(columns: Array, reading: Array) -> Array:
    """Return the coefficients of each drive, shape (n, c - 1)."""
    return np.array([np.linalg.lstsq(c, y, rcond=None)[0] for c, y in zip(columns, reading.T, strict=True)])


def carrying(columns: Array, payload: float) -> Array:
    """Return the columns of an arm that carries something, shape (n, T, c - 1)."""
    torque = columns[:, :, :1] + payload * columns[:, :, -1:]
    return np.concatenate([torque, columns[:, :, 1:-1]], axis=2)


def best_payload(columns: Array, reading: Array, heaviest: float) -> float:
    """Return the payload with which all drives agree best [kg], from none to the largest that may be unstated."""
    if heaviest <= 0:
        return 0.0
    found = minimize_scalar(
        lambda mass: total_misfit(columns, reading, float(mass)),
        bounds=(0.0, heaviest),
        options={"xatol": 1e-3 * heaviest},
    )
    return float(found.x) if found.fun < total_misfit(columns, reading, 0.0) else 0.0


def total_misfit(columns: Array, reading: Array, payload: float) -> float:
    """Return the logarithm of what is left, summed over drives: the likelihood, each drive with its own noise."""
    return float(np.sum(np.log(np.maximum(misfit(carrying(columns, payload), reading), TINY))))


def misfit(columns: Array, reading: Array) -> Array:
    """Return the share of each reading's variance that is left, shape (n,)."""
    left = reading.T - np.einsum("jtc,jc->jt", columns, solved(columns, reading))
    return np.asarray(np.var(left, axis=1) / np.maximum(np.var(reading, axis=0), TINY))


def shifted(time: Array, reading: Array, delay: float) -> Array:
    """Return readings as they would be without a delay, shape (T, n); the spectrum of their noise is kept.

    Straight lines between samples would average noise, most at half a sample, and so favour delays of that size. Here
    every frequency is turned by its own phase. What would be seen beyond the ends is each reading mirrored there,
    through its first and its last value.

    Args:
        time: Shape (T,) [s], even.
        reading: Shape (T, n).
        delay: [s], by which the readings are late.
    """
    last = len(time) - 1
    step = (time[-1] - time[0]) / last
    rise = (reading[-1] - reading[0]) / last
    swing = reading - reading[0] - np.arange(last + 1)[:, None] * rise  # zero at both ends
    mirrored = np.concatenate([swing, -swing[-2:0:-1]])  # one period
    turn = np.exp(2j * np.pi * np.fft.rfftfreq(2 * last, step) * delay)
    moved = np.fft.irfft(np.fft.rfft(mirrored, axis=0) * turn[:, None], 2 * last, axis=0)[: last + 1]
    return np.asarray(reading[0] + (np.arange(last + 1)[:, None] + delay / step) * rise + moved)
