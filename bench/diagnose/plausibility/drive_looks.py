"""A first look at drives and clock: every channel as a linear model of what the nominal robot needs.

    y = s gravity + m motion + Coulomb sign(v) + viscous v + offset + payload + gas

Gravity and motion (inertia, centrifugal and Coriolis torque) are parts of the nominal model's torque; all else is free.
A channel that is scaled has s = m; a clock that counts c seconds for each second leaves gravity and makes all joints'
m / s = c^2, because accelerations and products of velocities go with the inverse square of time.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri

from bench.diagnose.plausibility.drive_picture import LEAST, DrivePicture, needed_torque
from bench.diagnose.plausibility.physical_fit import FITS
from bench.diagnose.replay.replay import Replay
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

SLOW = 1e-6  # rounding: times the speed, at which nothing of the motion is left but its direction
TOLD = 0.02  # assumed: of a channel's rms, that a part must have of its own beside all others, to be told
LEVEL = 0.999  # declared: of intervals: by chance, one healthy clock or channel in a thousand is outside


@dataclass(frozen=True)
class Factor:
    """By how much a part of the nominal model is to be multiplied.

    Attributes:
        value: The factor; nan where it cannot be told.
        sigma: Its standard error, neighbouring readings correlated.
        share: Of the part's rms, that nothing else of the channel explains; it alone tells the factor.
    """

    value: float
    sigma: float
    share: float = 1.0

    @property
    def relative(self) -> float:
        """Standard error of its logarithm; inf where it cannot be told or is not positive."""
        return self.sigma / self.value if self.value > 0 else np.inf


UNTOLD = Factor(np.nan, np.inf)


@dataclass(frozen=True)
class DriveLook:
    """What a drive's channel makes of the nominal model.

    Attributes:
        index: Of the drive.
        column: Of its channel.
        whole: Factor of the model's torque in all.
        gravity: Factor of its part at rest.
        motion: Factor of its part that comes with motion.
        fits: Whether the model then leaves less than `FITS` of the channel's variance.
    """

    index: int
    column: str
    whole: Factor
    gravity: Factor
    motion: Factor
    fits: bool


def drive_looks(picture: DrivePicture, at_rest: Array) -> tuple[DriveLook, ...]:
    """Return a look at each drive that moves enough.

    Args:
        picture: What the drives did.
        at_rest: Shape (T, n) [Nm], from `resting_torque`.
    """
    found = []
    for j, name in enumerate(picture.names):
        rows = np.isfinite(picture.observed[:, j]) & ~picture.standing[:, j]
        if not name or rows.sum() < LEAST:
            continue
        y, free = picture.observed[rows, j], picture.columns(j)[rows, 1:]
        gravity = at_rest[rows, j]
        motion = picture.model[rows, j] - gravity
        (whole,), _ = _factors(y, [gravity + motion], free)
        (of_gravity, of_motion), left = _factors(y, [gravity, motion], free)
        found.append(DriveLook(j, name, whole, of_gravity, of_motion, left < FITS))
    return tuple(found)


def resting_torque(replay: Replay) -> Array:
    """Return the nominal model's torque without what comes with motion, shape (T, n) [Nm].

    Args:
        replay: Of segments with readings of drives.

    Raises:
        ConvergenceError: The model finds no balance.
    """
    resting = tuple(
        replace(
            segment,
            motion=replace(
                segment.motion, velocity=SLOW * segment.motion.velocity, acceleration=0 * segment.motion.acceleration
            ),
        )
        for segment in replay.segments
    )
    return needed_torque(replay.of(resting))


def _factors(y: Array, parts: Sequence[Array], free: Array) -> tuple[list[Factor], float]:
    """Return the factor of each part, and the share of the variance that is left; parts without an own share are out.

    Args:
        y: Shape (T,).
        parts: Shape (T,) each.
        free: Shape (T, k), what else the channel is made of.
    """
    size = float(np.sqrt(np.mean(y**2)))
    told = [i for i, part in enumerate(parts) if _own(part, free) > TOLD * size]
    columns = np.column_stack([*(parts[i] for i in told), free])
    scale = np.linalg.norm(columns, axis=0)
    columns = columns[:, scale > 0] / scale[scale > 0]
    solution = np.linalg.lstsq(columns, y)[0]
    rest = y - columns @ solution
    variance = np.linalg.pinv(columns.T @ columns) * float(np.mean(rest**2)) * inflation(rest)
    factors = [UNTOLD for _ in parts]
    for place, i in enumerate(told):
        others = np.column_stack([*(parts[k] for k in told if k != i), free])
        share = _own(parts[i], others) / float(np.sqrt(np.mean(parts[i] ** 2)))
        value, sigma = solution[place] / scale[place], np.sqrt(variance[place, place]) / scale[place]
        factors[i] = Factor(float(value), float(sigma), share)
    return factors, float(np.var(rest) / np.var(y)) if np.var(y) > 0 else np.inf


def _own(part: Array, others: Array) -> float:
    """Return the rms of what others do not explain of a part."""
    scale = np.maximum(np.linalg.norm(others, axis=0), 1e-12)
    rest = part - others / scale @ np.linalg.lstsq(others / scale, part)[0]
    return float(np.sqrt(np.mean(rest**2)))


def inflation(rest: Array) -> float:
    """Return by how much neighbours that are alike make a variance larger: (1 + r) / (1 - r), first order."""
    power = float(np.mean(rest**2))
    alike = float(np.mean(rest[1:] * rest[:-1])) / power if power > 0 else 0.0
    alike = float(np.clip(alike, 0.0, 1 - 1 / len(rest)))
    return (1 + alike) / (1 - alike)


@dataclass(frozen=True)
class Clock:
    """How many seconds a recording's clock counts for each second, by the inertia of all joints.

    Attributes:
        rate: The number.
        low, high: Ends of its interval.
        drives: How many joints tell.
    """

    rate: float
    low: float
    high: float
    drives: int


def clock_of(looks: Sequence[DriveLook], compiled: CompiledRobot, level: float) -> Clock | None:
    """Return the rate of the clock, None where fewer than two joints tell.

    Each joint's m / s is as uncertain as its rotor's inertia and, where gravity does not tell the gain of its channel,
    its torque constant. Where joints differ by more than that, the interval is as much wider (Birge). One joint alone
    may have another inertia: the rotor that is known best counts as no better known than the next.

    Args:
        looks: At the drives.
        compiled: The nominal robot.
        level: Of the interval.
    """
    figures = compiled.robot.figures
    current = figures.instruments.current
    logs, sigmas, rotors = [], [], []
    for look in looks:
        rotor = float(figures.drive_uncertainty.rotor_inertia[look.index])
        if not look.fits or look.motion.relative > rotor:
            continue
        told = look.gravity.relative < rotor
        if not told and figures.uncertainty.payload_kg:  # a payload that nobody stated has inertia, too
            continue
        gain = float(np.hypot(current.gain_sigma if current else 0.0, figures.drives[look.index].torque_constant_error))
        logs.append(np.log(look.motion.value / (look.gravity.value if told else 1.0)))
        of_gain = look.gravity.relative if told else gain
        sigmas.append(np.hypot(look.motion.relative, of_gain))
        rotors.append(rotor)
    if len(logs) < 2:
        return None
    values, weights = np.array(logs), np.hypot(np.maximum(rotors, np.sort(rotors)[1]), sigmas) ** -2.0
    mean = float(weights @ values / weights.sum())
    birge = max(1.0, float(weights @ (values - mean) ** 2) / (len(values) - 1))
    half = float(ndtri(0.5 + level / 2) * np.sqrt(birge / weights.sum()))
    rate, low, high = (float(np.exp(log / 2)) for log in (mean, mean - half, mean + half))
    return Clock(rate, low, high, len(logs))
