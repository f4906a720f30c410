"""What drives report, held against the arm's own torque: factor, sign and delay of each channel.

For each drive y = (M(q, v, a) + p L(q, v, a) + J_r a) / factor + c_v v + c_s sign(v) + c_0 by least squares, M the
inverse dynamics of the nominal links, L that of one kilogram at the load point, p the payload, one for all drives.
A rotor that nobody knows (`DriveUncertainty.rotor_is_unknown`) is not in that; its torque has a coefficient of its
own, c_a a.
Positions and readings have passed the same low-pass. A factor is as good as the masses are: it is told against them.
"""

from dataclasses import dataclass, replace

import numpy as np

from bench.identify.directions import Flags, directions
from bench.identify.drive_model import (
    TINY,
    Motion,
    best_payload,
    carrying,
    link_torque,
    misfit,
    model_columns,
    shifted,
    solved,
)
from bench.record.campaign import Array
from bench.robot.nominal_dynamics import NominalDynamics

BLOCKS = 8  # of the record, fitted one by one; their spread is the statistical error of the factor (assumed)
LATEST = 0.03  # [s], delay up to which is looked; drives report within a few control periods (assumed)
LAG_STEP = 1e-3  # [s] between the delays that are tried; a parabola through three of them tells the rest
CLEARLY_MOVING = 0.1  # of the top speed (assumed; friction that turns within 0.1 mrad was taken for 5 ms otherwise)
HALF = 0.5  # of what is unexplained: signs are turned only where that is left (assumed; symmetric signs leave all)
FREELY = 10.0  # effort: times the largest payload, up to which one is looked for that wants to be heavier
AT_MOST = 1e-2  # rounding: of a payload that was searched to a thousandth
SAMPLES = 400  # with which signs are tried, and centres of mass moved
LEAST_KNOWN = 0.5  # relative: an angle that is known less well is nudged by this, in place of infinitely far
NUDGE = 1e-4  # rounding: [m] by which a centre is moved for the change of the torque, in which it is linear


@dataclass(frozen=True)
class DriveScale:
    """How readings of n drives compare with the nominal arm.

    Attributes:
        factor: Shape (n,), motor torque at the joint by reading, sign included [Nm per unit of the reading]; nan of
            readings that do not count.
        sigma: Shape (n,), its relative standard deviation: statistics, masses and rotors together; inf of these.
        explained: Shape (n,), share of the reading's variance that model and friction explain; nan of these.
        delay: [s], by which readings lag positions.
        delay_sigma: [s], its standard deviation: scatter between parts of the record.
        turned: Shape (n,), whether the angle of a drive seems to count the other way round than in the model.
        payload: [kg], point mass at the load point with which all drives agree best.
        unsure: Shape (n,), drives whose direction is not told: with some of them the other way round, torques are
            explained as well. An arm and its mirror image need the same torques.
    """

    factor: Array
    sigma: Array
    explained: Array
    delay: float
    delay_sigma: float
    turned: Flags
    payload: float
    unsure: Flags

    @property
    def counts(self) -> Flags:
        """Whether the reading of a drive counted, shape (n,)."""
        return np.isfinite(self.factor)


def drive_scale(
    nominal: NominalDynamics,
    time: Array,
    position: Array,
    reading: Array,
    angle_sigma: Array | None = None,
    counts: Flags | None = None,
) -> DriveScale:
    """Compare readings of drives with the torque that the nominal arm needs.

    Args:
        nominal: The robot.
        time: Shape (T,) [s], even.
        position: Shape (T, n) [rad] or [m], low-passed.
        reading: Shape (T, n), in any unit, through the same low-pass.
        angle_sigma: Shape (n,), relative standard deviation of the scale of each position; inf where nobody knows it.
        counts: Shape (n,), whether a drive has a reading that tells anything, at least one; all, if left out.
    """
    read = np.ones(nominal.n_joints, dtype=np.bool_) if counts is None else counts
    reading = reading[:, read]
    turned, unsure = _turned(nominal, time, position, reading, read)
    motion = Motion.along(time, position * np.where(turned, -1.0, 1.0))
    columns = model_columns(nominal, motion)[read]
    heaviest = nominal.payload
    payload = best_payload(columns, reading, heaviest)
    delay, delay_sigma = _delay(time, reading, columns, _sliding(motion)[:, read])
    reading = shifted(time, reading, delay)
    payload = best_payload(columns, reading, heaviest)
    slopes = _slopes(columns, reading, payload)
    parts = []
    for rows in np.array_split(np.arange(len(time)), BLOCKS):
        cut, seen = columns[:, rows], reading[rows]
        parts.append(_slopes(cut, seen, best_payload(cut, seen, heaviest)))
    scatter = np.std(parts, axis=0, ddof=1) / np.sqrt(BLOCKS) / np.abs(slopes)
    needed = np.sqrt(np.mean(carrying(columns, payload)[:, :, 0] ** 2, axis=1))
    rotor = np.sqrt(np.mean((nominal.rotor_inertia * motion.acceleration) ** 2, axis=0))
    known = nominal.drive_uncertainty
    of_rotors = np.where(known.rotor_is_unknown, 0.0, known.rotor_inertia * rotor)[read] / needed
    of_centres = _of_centres(nominal, motion, columns, payload, read)
    stated = np.sqrt(nominal.uncertainty.mass**2 + of_rotors**2 + of_centres**2)
    if payload > (1 - AT_MOST) * heaviest > 0:  # it wants to be heavier; then factors would be other ones
        freely = _slopes(columns, reading, best_payload(columns, reading, FREELY * heaviest))
        stated = np.hypot(stated, np.abs(np.log(np.abs(freely / slopes))))
    if angle_sigma is not None:
        stated = np.hypot(stated, _of_angles(nominal, motion, reading, slopes, angle_sigma, read))
    explained = 1 - misfit(carrying(columns, payload), reading)
    sigma = np.hypot(scatter, stated)
    return DriveScale(
        _spread(1 / slopes, read, np.nan),
        _spread(sigma, read, np.inf),
        _spread(explained, read, np.nan),
        delay,
        delay_sigma,
        turned,
        payload,
        unsure,
    )


def _spread(values: Array, read: Flags, other: float) -> Array:
    """Return the values of drives that are read, shape (n,); another one for those that are not."""
    every = np.full(len(read), other)
    every[read] = values
    return every


def _sliding(motion: Motion) -> Array:
    """Return 1 where a drive moves clearly, 0 where it turns round, shape (T, n)."""
    speed = np.abs(motion.velocity)
    return np.where(speed > CLEARLY_MOVING * np.max(speed, axis=0), 1.0, 0.0)


def _delay(time: Array, reading: Array, columns: Array, sliding: Array) -> tuple[float, float]:
    """Return the delay with which least is left of readings, and its standard deviation [s].

    Instants at which a drive turns round are left out: bristles bend before friction has turned, which looks like a
    delay of the readings.

    Args:
        time: Shape (T,) [s], even.
        reading: Shape (T, n).
        columns: Shape (n, T, c), of the model at the angles' own times.
        sliding: Shape (T, n), 1 for the instants that count, else 0.
    """
    lags = np.arange(-LATEST, LATEST + 1e-9, LAG_STEP)
    parts = [slice(None), *(slice(rows[0], rows[-1] + 1) for rows in np.array_split(np.arange(len(time)), BLOCKS))]
    masked = [columns[:, rows] * sliding[rows].T[:, :, None] for rows in parts]
    left = np.empty((len(parts), len(lags)))
    for k, lag in enumerate(lags):
        seen = sliding * shifted(time, reading, lag)
        left[:, k] = [_left(model, seen[rows]) for model, rows in zip(masked, parts, strict=True)]
    whole, *cut = [_lowest(lags, misfits) for misfits in left]
    return whole, float(np.std(cut, ddof=1) / np.sqrt(BLOCKS))


def _left(columns: Array, reading: Array) -> float:
    """Return the logarithm of the variance that is left of each reading, summed over drives."""
    left = reading.T - np.einsum("jtc,jc->jt", columns, solved(columns, reading))
    return float(np.sum(np.log(np.maximum(np.var(left, axis=1), TINY))))


def _slopes(columns: Array, reading: Array, payload: float) -> Array:
    slopes = solved(carrying(columns, payload), reading)[:, 0]
    return np.where(slopes == 0, TINY, slopes)


def _lowest(lags: Array, misfits: Array) -> float:
    """Return where a parabola through the lowest three values has its foot."""
    k = int(np.clip(np.argmin(misfits), 1, len(lags) - 2))
    before, here, after = misfits[k - 1 : k + 2]
    bend = before - 2 * here + after
    return float(lags[k] + (0.5 * (before - after) / bend if bend > 0 else 0.0) * (lags[1] - lags[0]))


def _of_angles(
    nominal: NominalDynamics, motion: Motion, reading: Array, slopes: Array, angle_sigma: Array, read: Flags
) -> Array:
    """Return the relative error of the factor of drives that are read by the scale of angles, as that was estimated."""
    errors = np.zeros_like(slopes)
    for joint in np.flatnonzero(angle_sigma > 0):
        larger = np.ones(nominal.n_joints)
        larger[joint] += min(float(angle_sigma[joint]), LEAST_KNOWN)
        columns = model_columns(nominal, motion.seen(larger, 1))[read]
        errors += (_slopes(columns, reading, best_payload(columns, reading, nominal.payload)) / slopes - 1) ** 2
    return np.asarray(np.sqrt(errors))


def _of_centres(nominal: NominalDynamics, motion: Motion, columns: Array, payload: float, read: Flags) -> Array:
    """Return the relative error of the factor of drives that are read by centres of mass that are not as stated."""
    every = max(1, columns.shape[1] // SAMPLES)
    few = motion.seen(np.ones(nominal.n_joints), every)
    known = carrying(columns[:, ::every], payload)
    freed = [_apart(model[:, :1], model[:, 1:])[:, 0] for model in known]
    plain = link_torque(nominal.bodies, few)
    errors = np.zeros(len(columns))
    for body in range(nominal.n_joints):
        for axis in range(3):
            com = nominal.bodies.com.copy()
            com[body, axis] += NUDGE
            moved = (
                (link_torque(replace(nominal.bodies, com=com), few) - plain)
                / NUDGE
                * nominal.uncertainty.centre_of_mass_m
            )
            errors += [
                float(np.dot(f, d) / max(np.dot(f, f), TINY)) ** 2 for f, d in zip(freed, moved.T[read], strict=True)
            ]
    return np.asarray(np.sqrt(errors))


def _apart(values: Array, others: Array) -> Array:
    """Return what of some columns others cannot make, by least squares."""
    return np.asarray(values - others @ np.linalg.lstsq(others, values, rcond=None)[0])


def _turned(nominal: NominalDynamics, time: Array, position: Array, reading: Array, read: Flags) -> tuple[Flags, Flags]:
    """Return which angles have to be turned, and of which it is not told.

    None is turned where that explains no more than half of what is left; directions that explain no more than twice as
    badly are not told apart. Of as many turns the best counts; more turns have to leave half of what fewer leave.
    """
    every = max(1, len(time) // SAMPLES)
    motion, seen = Motion.along(time, position), reading[::every]

    def misfit_of(turned: Flags) -> float:
        columns = model_columns(nominal, motion.seen(np.where(turned, -1.0, 1.0), every))[read]
        return float(np.sum(misfit(carrying(columns, best_payload(columns, seen, nominal.payload)), seen)))

    tried = directions(position.shape[1])
    misfits = [misfit_of(turned) for turned in tried]
    best = 0
    for k in range(1, len(tried)):
        as_many = np.sum(tried[k]) == np.sum(tried[best])
        if misfits[k] < misfits[best] * (1.0 if as_many else HALF):
            best = k
    alike = [turned for turned, left in zip(tried, misfits, strict=True) if HALF * left <= misfits[best]]
    return tried[best], np.any([turned != tried[best] for turned in alike], axis=0)
