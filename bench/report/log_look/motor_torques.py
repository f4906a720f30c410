"""Lines of torques on the motors' side of the gears: with the gear ratio of the figures, or an estimate."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.identify.drive_scale import DriveScale
from bench.record.campaign import Array
from bench.record.look.families import Family
from bench.report.log_look.drive_factors import (
    agree,
    contradictions,
    each_drive,
    explained,
    is_told,
    sign_of,
    torque_column,
    unit_words,
)
from bench.report.log_look.lines import UNTOLD, Line, si_factor
from bench.robot.nominal_dynamics import NominalDynamics


@dataclass(frozen=True)
class Factors:
    """Gear ratios with which torques of the motors are read, shape (n,) each; whether the figures state them."""

    size: Array
    is_stated: NDArray[np.bool_]


def motor_factors(family: Family, scale: DriveScale, nominal: NominalDynamics) -> Factors:
    """Return gear ratios of the figures, or estimates; readings that nobody calls torques need not go by the former."""
    stated = np.isfinite(nominal.gear_ratio)
    if family.kind == "unknown" and not (np.all(stated) and agree(scale, nominal.gear_ratio)):
        stated = np.zeros_like(stated)
    return Factors(np.where(stated, nominal.gear_ratio, np.abs(scale.factor)), stated)


def motor_torques(family: Family, scale: DriveScale, nominal: NominalDynamics, factors: Factors) -> Iterator[Line]:
    """Yield the line of each drive; one that nothing tells is open."""
    column = [torque_column(number, nominal) for number in family.numbers]
    for (_, source, k), name in zip(each_drive(family), column, strict=True):
        told, to_si = explained(scale, k), si_factor(family)
        if factors.is_stated[k]:
            why = f"{told}; gear ratio {factors.size[k]:.6g} of the figures{unit_words(family)}"
            yield Line(name, source, sign_of(scale, k) * to_si * float(factors.size[k]), 0.0, why)
        elif not is_told(scale, k):
            why = f"{told}; this log does not tell the factor: write gear ratio or constant{unit_words(family)}"
            yield Line(name, source, to_si, 0.0, why, is_open=True)
        else:
            wide = bool(scale.sigma[k] > UNTOLD)
            remedy = ": not told by this log, write the gear ratio" if wide else ""
            why = f"{told}; +- {100 * scale.sigma[k]:.0f} %{remedy}{unit_words(family)}"
            factor = float(f"{to_si * sign_of(scale, k) * factors.size[k]:.3g}")
            yield Line(name, source, factor, 0.0, why, is_open=wide)


def about_motor_torques(family: Family, scale: DriveScale, nominal: NominalDynamics, factors: Factors) -> Iterator[str]:
    """Yield which factors are estimates or are not told, and which the log contradicts."""
    yield from contradictions("gear_ratio", np.where(factors.is_stated, factors.size, np.nan), scale, nominal)
    estimated = ~factors.is_stated & (scale.sigma <= UNTOLD)
    if np.any(estimated):
        yield (
            f"factors of {family.shown} are estimates: write gear ratios or constants there where they are known, else "
            f"`gain_sigma: {np.max(scale.sigma[estimated]):.2g}` under instruments: torque: of figures.yaml"
        )
    elif not np.any(factors.is_stated):
        yield (
            f"this log tells no factor of {family.shown} to {100 * UNTOLD:.0f} %, so none is proposed: write gear "
            "ratios or torque constants there, or look at a log of larger and faster movements"
        )
