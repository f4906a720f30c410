"""Held-out torque errors of the diagnosed model beside those of least squares, at the same readings."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.special import stdtr

from bench.diagnose.baseline.least_squares import least_squares_at_bins
from bench.diagnose.cross_validation.floor import measured
from bench.diagnose.cross_validation.folds import folds_of
from bench.diagnose.cross_validation.leave_out import errors_of_folds, tangent_of
from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.held_out import SAME
from bench.identify.dynamics.warming import Warming, warming_of
from bench.record.campaign import Array

FAR = 1.1  # effort: ratio of errors, from where another diagnosis is worth its time
LEAST_SQUARES = ("plain_least_squares", "first_pass")


@dataclass(frozen=True)
class DriveErrors:
    """Errors of the torque of one drive in motion, at readings that were held out.

    Attributes:
        drive: Its number, from 1.
        joint: Its name in the model.
        unit: "Nm", or "N" of a slide.
        readings: How many were compared.
        measured: Root mean square of the torque itself.
        nominal: Of what the nominal model leaves as it stands.
        plain_least_squares: Of what least squares of base parameters and friction leaves, without prior.
        first_pass: Of what the first pass leaves.
        diagnosed: Of what the diagnosed model leaves.
        chance: Probability that least squares, the better of the two, seems so much better than the diagnosed model by
            chance, over what was held out at a time.
        is_missed: Whether least squares is better, here or on all drives together, by more than chance brings about
            anywhere at the declared rate, and here by more than counts as the same.
    """

    drive: int
    joint: str
    unit: str
    readings: int
    measured: float
    nominal: float
    plain_least_squares: float
    first_pass: float
    diagnosed: float
    chance: float
    is_missed: bool

    @property
    def better(self) -> str:
        """Name of the better of the two least squares, from `LEAST_SQUARES`."""
        return min(LEAST_SQUARES, key=lambda name: float(getattr(self, name)))

    @property
    def least_squares(self) -> float:
        """What the better of the two least squares leaves."""
        return float(getattr(self, self.better))


@dataclass(frozen=True)
class Baseline:
    """The diagnosed model beside least squares.

    Attributes:
        by: What was held out at a time.
        folds: How many.
        drives: Those that move and were read.
        repeats: Whether what was held out goes over the same angles as the rest.
        warming: How friction falls from run to run, in the first pass; None where that may be chance.
    """

    by: Literal["recording", "run", "block"]
    folds: int
    drives: tuple[DriveErrors, ...]
    repeats: bool
    warming: Warming | None = None

    @property
    def missed(self) -> tuple[DriveErrors, ...]:
        """Drives that least squares predicts better for sure, the one with the largest ratio first."""
        found = [drive for drive in self.drives if drive.is_missed]
        return tuple(sorted(found, key=lambda drive: drive.least_squares / drive.diagnosed))

    @property
    def lags(self) -> bool:
        """Whether least squares predicts drives better, one of them for sure or all together by far."""
        ratios = [drive.diagnosed / drive.least_squares for drive in self.drives]
        return bool(self.missed) or float(np.exp(np.mean(np.log(ratios)))) > FAR

    def over(self, other: "Baseline") -> float:
        """Return the diagnosed errors over those of another diagnosis of this campaign, geometric mean of drives."""
        known = {drive.drive: drive.diagnosed for drive in other.drives}
        shared = [drive for drive in self.drives if drive.drive in known]
        return float(np.exp(np.mean([np.log(drive.diagnosed / known[drive.drive]) for drive in shared])))


def baseline_of(linear: LinearisedModel, fit: Fit, first: FirstPass, rate: float) -> Baseline | None:
    """Return the diagnosed model beside least squares; None where they have no reading in common.

    All are fitted without the same recording, run or block of the only run, and compared at the bins of motion in
    which a drive moves and was read. What belongs to one recording is fitted to it by the diagnosis; least squares
    knows no such thing.

    Args:
        linear: The campaign.
        fit: The diagnosed model.
        first: The first pass over the same campaign.
        rate: Share of campaigns in which any drive may be called missed by chance.
    """
    folds = folds_of(linear)
    diagnosed = errors_of_folds(linear, fit, tangent_of(linear, fit), folds)
    observed = np.where(measured(linear), linear.observed, np.nan)
    predicted = least_squares_at_bins(linear, first, folds)
    found: list[tuple[int, int, dict[str, Array]]] = []
    for c, quantity in enumerate(linear.quantities):
        if not quantity.is_drive:
            continue
        j = quantity.index
        to_torque = float(first.nominal.torque_constant[j]) if quantity.kind == "current" else 1.0
        torque = to_torque * observed[:, c]
        errors = {name: torque - values[:, j] for name, values in predicted.items()}
        errors |= {"measured": torque, "nominal": to_torque * linear.residual[:, c]}
        errors |= {"diagnosed": to_torque * diagnosed[:, c]}
        used = np.all([np.isfinite(error) for error in errors.values()], axis=0)
        if used.any():
            squares = {name: folds.sums(np.where(used, error, 0.0) ** 2) for name, error in errors.items()}
            found.append((j, int(used.sum()), squares))
    if not found:
        return None
    # one half of the rate is for all drives together, for few runs say little of one; the other for each by itself
    together = min(
        2 * chance_of(*(np.array([squares[name] for _, _, squares in found]) for name in (rival, "diagnosed")))
        for rival in LEAST_SQUARES
    )
    alone = 1.0 if together < rate / 2 else rate / (2 * len(found))
    drives = tuple(_drive(first, j, count, squares, alone) for j, count, squares in found)
    return Baseline(folds.by, len(folds), drives, first.folds.repeats, warming_of(first))


def _drive(first: FirstPass, drive: int, count: int, squares: dict[str, Array], rate: float) -> DriveErrors:
    """Return the errors of a drive from sums of squares per fold, shape (K,) each."""
    rms = {name: float(np.sqrt(square.sum() / count)) for name, square in squares.items()}
    better = min(LEAST_SQUARES, key=lambda name: rms[name])
    chance = min(1.0, 2 * chance_of(squares[better], squares["diagnosed"]))  # the better of two: Bonferroni
    return DriveErrors(
        drive=drive + 1,
        joint=first.joints[drive],
        unit="Nm" if first.nominal.bodies.is_hinge[drive] else "N",
        readings=count,
        measured=rms["measured"],
        nominal=rms["nominal"],
        plain_least_squares=rms["plain_least_squares"],
        first_pass=rms["first_pass"],
        diagnosed=rms["diagnosed"],
        chance=chance,
        is_missed=chance < rate and rms["diagnosed"] > SAME * rms[better],
    )


def chance_of(least: Array, diagnosed: Array) -> float:
    """Return how likely chance makes least squares so much better, of squared errors per fold, shape (K,) each.

    Student's t of the logarithms of the ratio, one-sided: ratios, for a drive errs more in one run than in another;
    1 with less than two folds. Of several drives, shape (n, K), the mean in each fold counts.
    """
    both = (np.atleast_2d(least), np.atleast_2d(diagnosed))
    there = np.all([one > 0 for one in both], axis=(0, 1))
    gain = np.mean(np.log(both[1][:, there] / both[0][:, there]), axis=0)
    if len(gain) < 2:
        return 1.0
    error = float(gain.std(ddof=1)) / np.sqrt(len(gain))
    if error == 0.0:
        return float(gain.mean() <= 0)
    return float(stdtr(len(gain) - 1, -gain.mean() / error))
