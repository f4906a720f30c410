"""What drives report, held against the arm's own torque: factor, sign and delay of each channel.

For each drive y = (M(q, v, a) + p L(q, v, a) + J_r a) / factor + c_v v + c_s sign(v) + c_0 by least squares, M the
inverse dynamics of the nominal links, L that of one kilogram at the load point, p the payload, one for all drives.
Rotors that nobody knows (`GUESSED`) are not in that; their torque has a coefficient of its own, c_a a.
Positions and readings have passed the same low-pass. A factor is as good as the masses are: it is told against them.
"""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from scipy.optimize import minimize_scalar

from bench.identify.arm import Arm
from bench.record.campaign import Array
from bench.robot.bodies import RigidBodies
from bench.robot.nominal_dynamics import NominalDynamics
from bench.robot.payload import with_payload

BLOCKS = 8  # of the record, fitted one by one; their spread is the statistical error of the factor (assumed)
LATEST = 0.03  # [s], delay up to which is looked; drives report within a few control periods (assumed)
MOST_FLIPPED = 6  # drives up to which all signs of angles are tried; 64 fits
HALF = 0.5  # of what is unexplained: signs are turned only where that is left (assumed; symmetric signs leave all)
NOT_SHARP = 0.02  # of the top speed, over which the direction of a slow movement is not sharp (assumed)
SAMPLES = 400  # with which signs are tried, and centres of mass moved
GUESSED = 1.0  # uncertainty of rotors, a factor of two, from which they are guesses; sigma of what a file states is 0.1
NUDGE = 1e-4  # rounding: [m] by which a centre is moved for the change of the torque, in which it is linear

TINY = np.finfo(float).tiny

Flags = np.ndarray[tuple[int], np.dtype[np.bool_]]


@dataclass(frozen=True)
class DriveScale:
    """How readings of n drives compare with the nominal arm.

    Attributes:
        factor: Shape (n,), motor torque at the joint by reading, sign included [Nm per unit of the reading].
        sigma: Shape (n,), its relative standard deviation: statistics, masses and rotors together.
        explained: Shape (n,), share of the reading's variance that model and friction explain.
        delay: [s], by which readings lag positions.
        turned: Shape (n,), whether the angle of a drive seems to count the other way round than in the model.
        payload: [kg], point mass at the load point with which all drives agree best.
        unsure: Shape (n,), drives whose direction is not told: with some of them the other way round, torques are
            explained as well. An arm and its mirror image need the same torques.
    """

    factor: Array
    sigma: Array
    explained: Array
    delay: float
    turned: Flags
    payload: float
    unsure: Flags


def drive_scale(nominal: NominalDynamics, time: Array, position: Array, reading: Array) -> DriveScale:
    """Compare readings of drives with the torque that the nominal arm needs.

    Args:
        nominal: The robot.
        time: Shape (T,) [s], even.
        position: Shape (T, n) [rad] or [m], low-passed.
        reading: Shape (T, n), in any unit, through the same low-pass.
    """
    turned, unsure = _turned(nominal, time, position, reading)
    motion = Motion.along(time, position * np.where(turned, -1.0, 1.0))
    columns = _columns(nominal, motion)
    heaviest = nominal.payload
    lags = np.arange(-LATEST, LATEST + 1e-9, 1e-3)
    payload = _payload(columns, reading, heaviest)
    misfits = np.array([_total(columns, _shifted(time, reading, lag), payload) for lag in lags])
    delay = _lowest(lags, misfits)
    reading = _shifted(time, reading, delay)
    payload = _payload(columns, reading, heaviest)
    slopes = _slopes(columns, reading, payload)
    parts = []
    for rows in np.array_split(np.arange(len(time)), BLOCKS):
        cut, seen = columns[:, rows], reading[rows]
        parts.append(_slopes(cut, seen, _payload(cut, seen, heaviest)))
    scatter = np.std(parts, axis=0, ddof=1) / np.sqrt(BLOCKS) / np.abs(slopes)
    needed = np.sqrt(np.mean(_with(columns, payload)[:, :, 0] ** 2, axis=1))
    rotor = np.sqrt(np.mean((nominal.rotor_inertia * motion.acceleration) ** 2, axis=0))
    of_rotors = 0.0 if _is_guessed(nominal) else nominal.uncertainty.rotor_inertia * rotor / needed
    stated = np.sqrt(nominal.uncertainty.mass**2 + of_rotors**2 + _of_centres(nominal, motion, columns, payload) ** 2)
    explained = 1 - _misfit(_with(columns, payload), reading)
    return DriveScale(1 / slopes, np.hypot(scatter, stated), explained, delay, turned, payload, unsure)


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

    def seen(self, signs: Array, every: int) -> "Motion":
        """Return each so many samples of the motion with other signs."""
        parts = (self.position, self.velocity, self.acceleration)
        return Motion(*(signs * part[::every] for part in parts))


def _columns(nominal: NominalDynamics, motion: Motion) -> Array:
    """Return for each drive model torque, speed, direction, one, and the torque of 1 kg of payload, shape (n, T, c).

    Where rotors are guesses, acceleration stands before the payload; c is 5 or 6.
    """
    links = _torque(nominal.bodies, motion)
    payload = _torque(with_payload(nominal.bodies, 1.0, nominal.load_point), motion) - links
    guessed = [motion.acceleration] if _is_guessed(nominal) else []
    torque = links if guessed else links + nominal.rotor_inertia * motion.acceleration
    slow = NOT_SHARP * np.max(np.abs(motion.velocity), axis=0, initial=1e-9)
    direction = np.tanh(motion.velocity / slow)
    stack = np.stack([torque, motion.velocity, direction, np.ones_like(torque), *guessed, payload], axis=-1)
    return np.swapaxes(stack, 0, 1)


def _is_guessed(nominal: NominalDynamics) -> bool:
    return nominal.uncertainty.rotor_inertia >= GUESSED


def _torque(bodies: RigidBodies, motion: Motion) -> Array:
    """Return the torque that links need along a motion, shape (T, n)."""
    arm = Arm(bodies)
    states = zip(motion.position, motion.velocity, motion.acceleration, strict=True)
    return np.array([arm.inverse_dynamics(*state) for state in states])


def _solved(columns: Array, reading: Array) -> Array:
    """Return the coefficients of each drive, shape (n, c - 1)."""
    return np.array([np.linalg.lstsq(c, y, rcond=None)[0] for c, y in zip(columns, reading.T, strict=True)])


def _with(columns: Array, payload: float) -> Array:
    """Return the columns of an arm that carries something, shape (n, T, c - 1)."""
    torque = columns[:, :, :1] + payload * columns[:, :, -1:]
    return np.concatenate([torque, columns[:, :, 1:-1]], axis=2)


def _payload(columns: Array, reading: Array, heaviest: float) -> float:
    """Return the payload with which all drives agree best [kg], from none to the largest that may be unstated."""
    if heaviest <= 0:
        return 0.0
    found = minimize_scalar(
        lambda mass: _total(columns, reading, float(mass)), bounds=(0.0, heaviest), options={"xatol": 1e-3 * heaviest}
    )
    return float(found.x) if found.fun < _total(columns, reading, 0.0) else 0.0


def _total(columns: Array, reading: Array, payload: float) -> float:
    """Return the logarithm of what is left, summed over drives: the likelihood, each drive with its own noise."""
    return float(np.sum(np.log(np.maximum(_misfit(_with(columns, payload), reading), TINY))))


def _slopes(columns: Array, reading: Array, payload: float) -> Array:
    slopes = _solved(_with(columns, payload), reading)[:, 0]
    return np.where(slopes == 0, TINY, slopes)


def _misfit(columns: Array, reading: Array) -> Array:
    """Return the share of each reading's variance that is left, shape (n,)."""
    left = reading.T - np.einsum("jtc,jc->jt", columns, _solved(columns, reading))
    return np.asarray(np.var(left, axis=1) / np.maximum(np.var(reading, axis=0), TINY))


def _shifted(time: Array, reading: Array, delay: float) -> Array:
    """Return readings as they would be without a delay."""
    return np.stack([np.interp(time + delay, time, values) for values in reading.T], axis=1)


def _lowest(lags: Array, misfits: Array) -> float:
    """Return where a parabola through the lowest three values has its foot."""
    k = int(np.clip(np.argmin(misfits), 1, len(lags) - 2))
    before, here, after = misfits[k - 1 : k + 2]
    bend = before - 2 * here + after
    return float(lags[k] + (0.5 * (before - after) / bend if bend > 0 else 0.0) * (lags[1] - lags[0]))


def _of_centres(nominal: NominalDynamics, motion: Motion, columns: Array, payload: float) -> Array:
    """Return the relative error of each drive's factor by centres of mass that are not where they are stated."""
    every = max(1, columns.shape[1] // SAMPLES)
    few = motion.seen(np.ones(nominal.n_joints), every)
    known = _with(columns[:, ::every], payload)
    freed = [_apart(model[:, :1], model[:, 1:])[:, 0] for model in known]
    plain = _torque(nominal.bodies, few)
    errors = np.zeros(nominal.n_joints)
    for body in range(nominal.n_joints):
        for axis in range(3):
            com = nominal.bodies.com.copy()
            com[body, axis] += NUDGE
            moved = (
                (_torque(replace(nominal.bodies, com=com), few) - plain) / NUDGE * nominal.uncertainty.centre_of_mass_m
            )
            errors += [float(np.dot(f, d) / max(np.dot(f, f), TINY)) ** 2 for f, d in zip(freed, moved.T, strict=True)]
    return np.asarray(np.sqrt(errors))


def _apart(values: Array, others: Array) -> Array:
    """Return what of some columns others cannot make, by least squares."""
    return np.asarray(values - others @ np.linalg.lstsq(others, values, rcond=None)[0])


def _turned(nominal: NominalDynamics, time: Array, position: Array, reading: Array) -> tuple[Flags, Flags]:
    """Return which angles have to be turned, and of which it is not told.

    None is turned where that explains no more than half of what is left; directions that explain no more than twice as
    badly are not told apart.
    """
    n = position.shape[1]
    plain = np.zeros(n, dtype=np.bool_)
    if n > MOST_FLIPPED:
        return plain, plain
    every = max(1, len(time) // SAMPLES)
    motion, seen = Motion.along(time, position), reading[::every]

    def misfit_of(turned: Flags) -> float:
        columns = _columns(nominal, motion.seen(np.where(turned, -1.0, 1.0), every))
        return float(np.sum(_misfit(_with(columns, _payload(columns, seen, nominal.payload)), seen)))

    tried = [np.array(signs) for signs in sorted(product((False, True), repeat=n), key=sum)]
    misfits = [misfit_of(turned) for turned in tried]
    best, least = 0, HALF * misfits[0]
    for k in range(1, len(tried)):
        if misfits[k] < least * (HALF if best else 1.0):  # fewer turns first
            best, least = k, misfits[k]
    alike = [turned for turned, misfit in zip(tried, misfits, strict=True) if HALF * misfit <= misfits[best]]
    return tried[best], np.any([turned != tried[best] for turned in alike], axis=0)
