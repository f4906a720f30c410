"""What drives report, held against the arm's own torque: factor, sign and delay of each channel.

For each drive y = s M(q, v, a) + c_v v + c_s sign(v) + c_0, M the torque of the arm with a payload that nobody stated
and with all that may be wrong with its links and rotors (`drive_fit.py`), 1 / s the factor. A rotor that nobody knows
(`DriveUncertainty.rotor_is_unknown`) is not in that; its torque has a coefficient of its own, c_a a.
Positions and readings have passed the same low-pass. A factor is as good as the masses are: it is told against them.
"""

from dataclasses import dataclass

import numpy as np

from bench.identify.directions import Flags
from bench.identify.drive_delay import delay_of, sliding
from bench.identify.drive_fit import arm_errors, drive_fit
from bench.identify.drive_model import (
    TINY,
    LinksAlong,
    Motion,
    best_payload,
    carrying,
    misfit,
    model_columns,
    shifted,
    solved,
)
from bench.identify.turned_angles import TurnedAngles, turned_angles
from bench.record.campaign import Array
from bench.robot.nominal_dynamics import NominalDynamics

FREELY = 10.0  # effort: times the largest payload, up to which one is looked for that wants to be heavier
AT_MOST = 1e-2  # rounding: of a payload that was searched to a thousandth
LEAST_KNOWN = 0.5  # relative: an angle that is known less well is nudged by this, in place of infinitely far


@dataclass(frozen=True)
class DriveScale:
    """How readings of n drives compare with the nominal arm.

    Attributes:
        factor: Shape (n,), motor torque at the joint by reading, sign included [Nm per unit of the reading]; nan of
            readings that do not count.
        sigma: Shape (n,), its relative standard deviation: statistics, masses, centres, rotors and
            payload together; inf of these.
        explained: Shape (n,), share of the reading's variance that model and friction explain; nan of these.
        delay: [s], by which readings lag positions.
        delay_sigma: [s], its standard deviation: scatter between parts of the record.
        payload, payload_sigma: [kg], of what hangs at the load point or beside it, and its standard deviation.
        angles: Which of them seem to count the other way round than in the model.
    """

    factor: Array
    sigma: Array
    explained: Array
    delay: float
    delay_sigma: float
    payload: float
    payload_sigma: float
    angles: TurnedAngles

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
    angles = turned_angles(nominal, time, position, reading, read)
    motion = Motion.along(time, position * np.where(angles.turned, -1.0, 1.0))
    along = LinksAlong.of(nominal, motion)
    columns, errors = model_columns(nominal, along)[read], arm_errors(nominal, along)[read]
    heaviest = nominal.payload
    slides = sliding(motion)[:, read]
    fit = drive_fit(columns, errors, reading, best_payload(columns, reading, heaviest), heaviest, slides)
    delay, delay_sigma = delay_of(time, reading, columns, errors, fit, slides)
    reading = shifted(time, reading, delay)
    fit = drive_fit(columns, errors, reading, fit.payload, heaviest, slides)
    sigma = fit.sigma
    if fit.payload > (1 - AT_MOST) * heaviest > 0:  # it wants to be heavier; then factors would be other ones
        freely = drive_fit(columns, errors, reading, fit.payload, FREELY * heaviest, slides)
        sigma = np.hypot(sigma, np.abs(np.log(np.abs(freely.slope / fit.slope))))
    if angle_sigma is not None:
        sigma = np.hypot(sigma, _of_angles(nominal, along, reading, angle_sigma, read))
    explained = 1 - misfit(np.concatenate([fit.torque[:, :, None], columns[:, :, 1:-1]], axis=2), reading)
    return DriveScale(
        _spread(1 / fit.slope, read, np.nan),
        _spread(sigma, read, np.inf),
        _spread(explained, read, np.nan),
        delay,
        delay_sigma,
        fit.payload,
        fit.payload_sigma,
        angles,
    )


def _spread(values: Array, read: Flags, other: float) -> Array:
    """Return the values of drives that are read, shape (n,); another one for those that are not."""
    every = np.full(len(read), other)
    every[read] = values
    return every


def _slopes(columns: Array, reading: Array, payload: float) -> Array:
    slopes = solved(carrying(columns, payload), reading)[:, 0]
    return np.where(slopes == 0, TINY, slopes)


def _of_angles(nominal: NominalDynamics, along: LinksAlong, reading: Array, angle_sigma: Array, read: Flags) -> Array:
    """Return the relative error of the factor of drives that are read by the scale of angles, as that was estimated."""
    given = model_columns(nominal, along)[read]
    slopes = _slopes(given, reading, best_payload(given, reading, nominal.payload))
    errors = np.zeros_like(slopes)
    for joint in np.flatnonzero(angle_sigma > 0):
        larger = np.ones(nominal.n_joints)
        larger[joint] += min(float(angle_sigma[joint]), LEAST_KNOWN)
        columns = model_columns(nominal, LinksAlong.of(nominal, along.motion.seen(larger, 1)))[read]
        errors += (_slopes(columns, reading, best_payload(columns, reading, nominal.payload)) / slopes - 1) ** 2
    return np.asarray(np.sqrt(errors))
