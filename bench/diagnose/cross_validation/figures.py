"""Everything that was fitted, as a table: figures of robot and instruments, and parameters of what was found."""

from dataclasses import dataclass

import numpy as np

from bench.diagnose.cross_validation.folds import folds_of
from bench.diagnose.cross_validation.jackknife import jackknife_variance
from bench.diagnose.cross_validation.leave_out import tangent_of
from bench.diagnose.extend.fit import Fit, Unknown
from bench.diagnose.extend.size import NORMAL_95
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.fitted import torque_constant_of
from bench.diagnose.replay.nuisances import Nuisance

MOVED = 2.0  # declared: DESIGN 6.5: whatever moved beyond two standard deviations is named
# exact: Of two estimates, from where on one is said to trade against the other: half of the variance of the one is
# then gone when the other is known (rho^2 = 1/2).
TRADES = float(np.sqrt(0.5))


@dataclass(frozen=True)
class FittedFigure:
    """One fitted parameter.

    Attributes:
        name: For people.
        kind: "figure" of robot or instruments, stated with an uncertainty; "finding": a parameter of a cause;
            "campaign": what belongs to these recordings and not to the robot, and is not handed over.
        unit: SI; "" for a relative deviation.
        stated: Value of the nominal robot; 0 for figures of which the deviation is given.
        found: As fitted.
        low, high: Ends of its 95 % interval.
        sigma: Standard deviation with which it is stated; nan for a finding, which nobody stated.
        sigmas: Found less stated, in standard deviations as stated; nan for a finding.
        trades_with: Name of the parameter with whose estimate its own is correlated most, "" where that is weak.
        correlation: Of both estimates; nan where it is weak.
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
    trades_with: str
    correlation: float

    @property
    def has_moved(self) -> bool:
        """Whether it is a stated figure that was found further away than its uncertainty explains."""
        return self.kind == "figure" and abs(self.sigmas) > MOVED


def fitted_figures(linear: LinearisedModel, fit: Fit) -> tuple[FittedFigure, ...]:
    """Return all parameters of a fit, findings first, then figures, those that moved most first.

    Their intervals count how much runs disagree (`jackknife.py`), as those of findings do wherever they are told.

    Args:
        linear: The campaign.
        fit: To all of it.
    """
    p, compiled = len(fit.nuisances), linear.replay.compiled
    constants = [torque_constant_of(compiled, nuisance) for nuisance in linear.nuisances]
    # what a drive reports falls where its constant rises
    sign = np.array([*(1.0 if constant is None else -1.0 for constant in constants), *np.ones(len(fit.unknowns))])
    tangent = tangent_of(linear, fit)
    covariance = np.linalg.inv(tangent.precision)
    by_noise = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(sign * by_noise, sign * by_noise)
    spread = np.maximum(by_noise, np.sqrt(jackknife_variance(tangent, *folds_of(linear).of_rows(linear))))
    spread[:p] = np.minimum(spread[:p], 1.0)  # what is stated is known without any data
    np.fill_diagonal(correlation, 0.0)
    names = [*map(str, linear.nuisances), *map(_name, fit.unknowns)]
    found = []
    for i in range(p + len(fit.unknowns)):
        partner = int(np.argmax(np.abs(correlation[i])))
        is_strong = abs(correlation[i, partner]) > TRADES
        if i < p:
            row = _figure(linear.nuisances[i], float(fit.nuisances[i]), float(spread[i]))
            constant = constants[i]
            row = row if constant is None else _of_constant(row, constant)
        else:
            row = _finding(fit.unknowns[i - p], float(fit.values[i - p]), float(spread[i]))
        rho = float(correlation[i, partner]) if is_strong else np.nan
        found.append(FittedFigure(names[i], *row, names[partner] if is_strong else "", rho))
    found.sort(key=lambda one: (one.kind != "finding", -abs(one.sigmas) if one.kind != "finding" else 0.0))
    return tuple(found)


_Row = tuple[str, str, float, float, float, float, float, float]


def _figure(nuisance: Nuisance, x: float, spread: float) -> _Row:
    """Return what a row says of a deviation that is x standard deviations as stated, give or take `spread` of them."""
    found, low, high = (nuisance.off_by(x + side * NORMAL_95 * spread) for side in (0, -1, 1))
    kind = "figure" if nuisance.is_simulated else "campaign"
    stated = nuisance.sigma / nuisance.widened
    return kind, nuisance.unit, 0.0, found, low, high, stated, x * nuisance.widened


def _of_constant(row: _Row, constant: float) -> _Row:
    """Return a row about the gain of what a drive reports as one about its torque constant [Nm/A], nan: relative."""
    kind, _, _, found, low, high, sigma, sigmas = row
    best, least, most = (1 / (1 + gain) if gain > -1 else np.inf for gain in (found, high, low))
    if np.isnan(constant):
        return kind, "", 0.0, best - 1, least - 1, most - 1, sigma, -sigmas
    return kind, "Nm/A", constant, constant * best, constant * least, constant * most, constant * sigma, -sigmas


def _finding(unknown: Unknown, value: float, spread: float) -> _Row:
    half, parameter = NORMAL_95 * spread, unknown.parameter
    return "finding", parameter.unit, parameter.null, value, value - half, value + half, np.nan, np.nan


def _name(unknown: Unknown) -> str:
    cause = unknown.cause
    is_everywhere = cause.place.kind == "robot" and cause.place.recording is None
    where = "" if is_everywhere else f" ({cause.place})"
    return f"{cause.effect.title}{where}: {unknown.parameter.name.replace('_', ' ')}"
