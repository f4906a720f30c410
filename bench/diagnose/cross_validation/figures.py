"""Everything that was fitted, as a table: figures of robot and instruments, and parameters of what was found."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri

from bench.diagnose.cross_validation.folds import folds_of
from bench.diagnose.cross_validation.jackknife import jackknife_variance
from bench.diagnose.cross_validation.leave_out import tangent_of
from bench.diagnose.extend.fit import Fit, Key, Unknown
from bench.diagnose.extend.size import NORMAL_95
from bench.diagnose.extend.told import told_sizes
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.fitted import torque_constant_of
from bench.diagnose.replay.nuisances import Nuisance
from bench.identify.told import is_told
from bench.record.campaign import Array

MOVED = 2.0  # declared: DESIGN 6.5: whatever moved beyond two standard deviations is named
CHANCE = 0.05  # declared: of diagnoses since which nothing has changed, those that say so of a figure
# exact: Of two estimates, from where on one is said to trade against the other: half of the variance of the one is
# then gone when the other is known (rho^2 = 1/2).
TRADES = float(np.sqrt(0.5))


@dataclass(frozen=True)
class FittedFigure:
    """One fitted parameter: `stated`, `earlier`, `found`, `low` and `high` are values of one and the same thing.

    Attributes:
        name: For people; "in recording x": the part of its own that a recording has, on top of that of the machine.
        kind: "figure" of robot or instruments, stated with an uncertainty; "finding": a parameter of a cause;
            "campaign": what belongs to these recordings and not to the robot, and is not handed over.
        unit: SI; "" for a share of what is stated.
        stated: What is stated of the robot, before any diagnosis; 0 for figures of which the deviation is given.
        found: As fitted.
        low, high: Ends of its 95 % interval.
        sigma: Standard deviation with which it was expected: about what is stated, or about what an earlier diagnosis
            had found; of a share, of that; of what is known to a factor, that factor less 1. nan for a finding, which
            nobody expected.
        sigmas: How far from that it was found, in these standard deviations; nan for a finding.
        trades_with: Name of the parameter with whose estimate its own is correlated most, "" where that is weak.
        correlation: Of both estimates; nan where it is weak.
        is_told: Whether data say more of it than was known without them (`identify/told.py`); if not, its value and
            interval are its prior's for the most part.
        earlier: What an earlier diagnosis had found, from which this one started; nan where it says nothing of it.
        has_changed: Whether it is another one than that diagnosis found, beyond what both know, however much it was
            expected to drift.
    """

    name: str
    kind: str
    unit: str
    stated: float
    found: float
    low: float
    high: float
    sigma: float
    sigmas: float
    trades_with: str = ""
    correlation: float = float("nan")
    is_told: bool = True
    earlier: float = float("nan")
    has_changed: bool = False

    @property
    def has_moved(self) -> bool:
        """Whether it was found further away than its uncertainty explains from what is stated or was found before."""
        return self.kind == "figure" and abs(self.sigmas) > MOVED


def fitted_figures(linear: LinearisedModel, fit: Fit, beside: Array | None = None) -> tuple[FittedFigure, ...]:
    """Return all parameters of a fit, findings first, then figures, those that moved most first.

    Their intervals count how much runs disagree (`jackknife.py`), as those of findings do wherever they are told.

    Args:
        linear: The campaign.
        fit: To all of it.
        beside: Shape (p + k,), variance of each parameter that comes on top of what the campaign leaves, of a nuisance
            in standard deviations of its prior; None: nothing does.
    """
    p, compiled = len(fit.nuisances), linear.replay.compiled
    constants = [torque_constant_of(compiled, nuisance) for nuisance in linear.nuisances]
    of_machine = {nuisance.name for nuisance in linear.nuisances if nuisance.recording is None}
    for i, (nuisance, constant) in enumerate(zip(linear.nuisances, constants, strict=True)):
        if constant and nuisance.recording is not None and nuisance.name in of_machine:
            constants[i] = np.nan, constant[1]  # the part of a day, as a share: it comes on top of the machine's
    # what a drive reports falls where its constant rises
    sign = np.array([*(1.0 if constant is None else -1.0 for constant in constants), *np.ones(len(fit.unknowns))])
    tangent = tangent_of(linear, fit)
    covariance = np.linalg.inv(tangent.precision)
    by_noise = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(sign * by_noise, sign * by_noise)
    spread = np.maximum(by_noise, np.sqrt(jackknife_variance(tangent, *folds_of(linear).of_rows(linear))))
    spread[:p] = np.minimum(spread[:p], 1.0)  # what is stated is known without any data
    np.fill_diagonal(correlation, 0.0)
    names = [*map(str, linear.nuisances), *(unknown.words for unknown in fit.unknowns)]
    told = _told(fit)
    wide = spread if beside is None else np.sqrt(spread**2 + beside)
    compared = max(sum(nuisance.earlier is not None for nuisance in linear.nuisances), 1)
    clear = float(-ndtri(CHANCE / (2 * compared)))
    found = []
    for i in range(p + len(fit.unknowns)):
        partner = int(np.argmax(np.abs(correlation[i])))
        is_strong = abs(correlation[i, partner]) > TRADES
        if i < p:
            row = _figure(linear.nuisances[i], float(fit.nuisances[i]), float(wide[i]), clear)
            row = replace(row, is_told=is_told(float(spread[i]) ** 2, 1.0))  # by the campaign, whatever comes on top
            constant = constants[i]
            row = row if constant is None else _of_constant(row, *constant)
        else:
            unknown = fit.unknowns[i - p]
            row = _finding(unknown, float(fit.values[i - p]), float(wide[i]), told[unknown.key])
        if is_strong:
            row = replace(row, trades_with=names[partner], correlation=float(correlation[i, partner]))
        found.append(row)
    found.sort(key=lambda one: (one.kind != "finding", -abs(one.sigmas) if one.kind != "finding" else 0.0))
    return tuple(found)


def changed_figures(linear: LinearisedModel, fit: Fit) -> tuple[FittedFigure, ...]:
    """Return what has changed since the diagnosis from which this one started, what is the robot's first.

    Args:
        linear: The campaign.
        fit: To all of it.
    """
    if not any(nuisance.earlier for nuisance in linear.nuisances):
        return ()
    of_robot = {str(nuisance) for nuisance in linear.nuisances if nuisance.moves_robot}
    changed = [figure for figure in fitted_figures(linear, fit) if figure.has_changed]
    return tuple(sorted(changed, key=lambda figure: figure.name not in of_robot))


def _figure(nuisance: Nuisance, x: float, spread: float, clear: float) -> FittedFigure:
    """Return a deviation that is x standard deviations of its prior, give or take `spread` of them.

    A factor is given as a share, and its standard deviation as that of the factor. What differs from what was found
    before by more than `clear` standard deviations of both has changed.
    """
    off, low, high = (nuisance.off_by(x + side * NORMAL_95 * spread) for side in (0, -1, 1))
    kind, unit, earlier = "figure" if nuisance.is_simulated else "campaign", nuisance.unit, nuisance.earlier
    if earlier is None:
        sigma, sigmas = nuisance.sigma / nuisance.widened, x * nuisance.widened
        return FittedFigure(str(nuisance), kind, unit, 0.0, off, low, high, sigma, sigmas)
    share = earlier.expected / nuisance.sigma
    sigma = nuisance.off_by(share) if nuisance.is_factor else earlier.expected
    has_changed = bool(abs(x) > clear * np.hypot(earlier.known / nuisance.sigma, spread))
    off, low, high = map(earlier.total, (off, low, high))
    figure = FittedFigure(str(nuisance), kind, unit, 0.0, off, low, high, sigma, x / share)
    return replace(figure, earlier=earlier.found, has_changed=has_changed)


def _of_constant(figure: FittedFigure, constant: float, of_constants: str) -> FittedFigure:
    """Return a figure about the gain of what a drive reports as one about its torque constant.

    Args:
        figure: What a drive reports is (1 + gain) of what it should.
        constant: Of the robot that was taken, which has what an earlier diagnosis found; nan: relative.
        of_constants: Unit of constants, Nm/A or of a slide N/A.
    """
    gains = figure.found, figure.high, figure.low, figure.earlier
    found, low, high, earlier = (np.inf if gain <= -1 else 1 / (1 + gain) for gain in gains)
    unit, stated, off, sigma = "", 0.0, 1.0, figure.sigma
    if not np.isnan(constant):
        stated = constant if np.isnan(figure.earlier) else constant * (1 + figure.earlier)
        found, low, high, earlier = (stated * part for part in (found, low, high, earlier))
        unit, off, sigma = of_constants, 0.0, constant * figure.sigma
    return replace(
        figure,
        unit=unit,
        stated=stated,
        found=found - off,
        low=low - off,
        high=high - off,
        sigma=sigma,
        sigmas=-figure.sigmas,
        earlier=earlier - off,
    )


def _finding(unknown: Unknown, value: float, spread: float, is_told: bool) -> FittedFigure:
    half, unit, null = NORMAL_95 * spread, unknown.parameter.unit, float(unknown.parameter.null)
    low, high = value - half, value + half
    return FittedFigure(unknown.words, "finding", unit, null, value, low, high, np.nan, np.nan, is_told=is_told)


def _told(fit: Fit) -> dict[Key, bool]:
    """Return, for each unknown of a fit, whether data say anything of it; a shape counts as told."""
    sizes = {(*cause.key, name): told for cause in fit.causes for name, told in told_sizes(cause, fit).items()}
    return {unknown.key: sizes.get(unknown.key, True) for unknown in fit.unknowns}
