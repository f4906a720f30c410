"""What the factor between a reading and the torque of its drive says: whether it is told, how near it is, in words."""

from collections.abc import Iterator

import numpy as np

from bench.identify.drive_scale import DriveScale
from bench.record.campaign import Array
from bench.record.look.families import Family
from bench.report.log_look.lines import UNTOLD, si_factor
from bench.robot.nominal_dynamics import NominalDynamics

NEAR_ONE = 0.25  # relative: a factor this near to one is no gear ratio; payload and masses may be off so far (assumed)
NINETY = 1.645  # exact: standard deviations to either side that hold 90 %
NINETY_NINE = 2.576  # exact: those that hold 99 %; six drives that are as stated stay within in 19 logs of 20


def is_told(scale: DriveScale, k: int) -> bool:
    """Return whether the 90 % interval of a factor leaves zero out: it tells a sign, and a size."""
    return bool(NINETY * scale.sigma[k] < 1)


def sign_of(scale: DriveScale, k: int) -> float:
    """Return -1 where a drive surely counts the other way round, else 1."""
    return float(np.sign(scale.factor[k])) if is_told(scale, k) else 1.0


def agree(scale: DriveScale, expected: Array) -> bool:
    """Return whether factors are sharply told, in the mean near to what is expected, and no drive is surely off."""
    is_off = np.abs(expected / np.abs(scale.factor) - 1) >= NINETY * scale.sigma
    return is_sharp(scale) and is_near(scale, expected) and not np.any(is_off[scale.counts])


def is_sharp(scale: DriveScale) -> bool:
    """Return whether a factor is told within `NEAR_ONE`; many do not tell more, for masses err for all drives alike."""
    return bool(NINETY * np.min(scale.sigma) < NEAR_ONE)


def is_near(scale: DriveScale, expected: Array) -> bool:
    """Return whether factors are in the mean near to what is expected."""
    return abs(mean_over_drives(np.log(np.abs(scale.factor) / expected), scale)) < NEAR_ONE


def mean_over_drives(values: Array, scale: DriveScale) -> float:
    """Return the mean over the drives that count, those that are told best the most."""
    return float(np.average(values[scale.counts], weights=scale.sigma[scale.counts] ** -2.0))


def estimate(scale: DriveScale, k: int) -> str:
    """Return the size of a factor and its standard deviation, in words."""
    size = abs(scale.factor[k])
    return f"{size:.3g} +- {100 * scale.sigma[k]:.0f} %" if is_told(scale, k) else "not told"


def explained(scale: DriveScale, k: int) -> str:
    """Return how much of a reading the model explains, in words."""
    return f"{100 * scale.explained[k]:.0f} % explained"


def unit_words(family: Family) -> str:
    """Return the unit in the name of readings, where it is none of the SI."""
    return f"; unit {family.unit} in its name" if si_factor(family) != 1 else ""


def each_drive(family: Family) -> Iterator[tuple[int, str, int]]:
    """Yield number, column and place of each drive."""
    for number, source in zip(family.numbers, family.sources, strict=True):
        yield number, source, number - 1


def torque_column(number: int, nominal: NominalDynamics) -> str:
    """Return the column of a campaign for the torque or force of a drive."""
    return f"tau_motor_{number}_{'nm' if nominal.bodies.is_hinge[number - 1] else 'n'}"


def contradictions(key: str, stated: Array, scale: DriveScale, nominal: NominalDynamics) -> Iterator[str]:
    """Yield where a log that tells a factor well speaks against the figures, beyond the interval of 99 %."""
    off = [
        f"{nominal.bodies.names[k]} {stated[k]:.4g} stated, {estimate(scale, k)} by torque"
        for k in np.flatnonzero(np.isfinite(stated) & (scale.sigma <= UNTOLD)).tolist()
        if abs(np.log(np.abs(scale.factor[k]) / stated[k])) > NINETY_NINE * scale.sigma[k]
    ]
    if off:
        yield (
            f"{key} of the figures is used, but this log contradicts it: {'; '.join(off)}. Look at that figure, the "
            "unit, the payload, the masses, and a spring or balancer that the model lacks"
        )
