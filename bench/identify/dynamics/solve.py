"""Weighted least squares with priors, torque and angles aligned, noise estimated: the first pass's parameters.

A row counts by the variance of its drive's residuals times the length of their memory, so that data and prior are
weighed right; the covariance of the estimate takes the autocorrelation of the residuals as it is (a "sandwich").
Whitening by the same autocorrelation would be more efficient if the model were right; here it trades the slow part of
a motion, which later motions share, for the fast part, which the model describes worst.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import optimize

from bench.identify.dynamics.noise import Noise, noise_of
from bench.identify.dynamics.normal import Normal, Weighed, likeliest_widths, normal_of, posterior, right_of
from bench.identify.dynamics.prior import Prior
from bench.identify.dynamics.rows import DriveRows
from bench.identify.dynamics.widths import Widths
from bench.record.campaign import Array

# effort: of weighting and linearising; gain and gas shape are corrections of some per cent, errors go with their cubes
PASSES = 4
# derived: of a period of the cut-off, either way, within which a delay is looked for; what is later looks turned round
LATEST = 0.25
DELAYS = 17  # effort: tried over this range before the best is refined
FINE = 1e-6  # rounding: [s], to which it is refined


@dataclass(frozen=True)
class Solution:
    """The posterior.

    Attributes:
        parameters: Shape (p,).
        covariance: Shape (p, p), of their errors.
        prior_sigma: Shape (p,), standard deviations before the data, with the widths that were chosen.
        widths: Of the prior, as the evidence has them.
        delay: By how much torques are later than angles [s].
        delay_sigma: Its standard deviation [s]; 0 where it was not looked for.
        noise: One for each drive; None for a drive without rows.
        drives: Rows with factors and weights of the last pass.
        normal: The normal equations of all rows.
        freedom: Independent readings less what the parameters took of them.
        not_taken: Delay of a fit with one, and its standard deviation [s], where that predicts no better; None:
            there was no other fit.
    """

    parameters: Array
    covariance: Array
    prior_sigma: Array
    widths: Widths
    delay: float
    delay_sigma: float
    noise: tuple[Noise | None, ...]
    drives: tuple[Weighed, ...]
    normal: Normal
    freedom: float
    not_taken: tuple[float, float] | None = None


def solve(
    rows: Sequence[DriveRows],
    prior: Prior,
    cutoff_hz: float,
    inflation: Array,
    find_delay: bool = True,
    begin: Widths | None = None,
) -> Solution:
    """Return the posterior of the parameters.

    Args:
        rows: Of each drive.
        prior: Of the parameters.
        cutoff_hz: Of the filter [Hz]; bounds the delay that is looked for.
        inflation: Shape (n,), by how much the variance of each drive's noise exceeds that of its residuals.
        find_delay: Whether torques may be later than angles.
        begin: Widths to begin with, by default the usual; what they hold, and optional friction, stay.
    """
    size, parameters, delay = len(prior.mean), prior.mean, 0.0
    widths = begin or prior.usual()
    noise = [_as_measured(one) for one in rows]
    for trial in range(2 * PASSES):
        # By variance alone at first. Then the memory is known and counts; were it found anew each time, a drive that
        # counts less would fit worse, seem to remember for longer, and count still less.
        with_memory = trial >= PASSES
        drives = tuple(
            Weighed.about(one, parameters, _weight(left, with_memory)) for one, left in zip(rows, noise, strict=True)
        )
        normal = normal_of(drives, delay, size)
        widths = likeliest_widths(normal, prior, widths)
        if find_delay and trial in (1, PASSES):  # once the model is near, and once what counts is known
            delay = _delay(drives, normal, prior, widths, cutoff_hz)
            normal = Normal(normal.gram, right_of(drives, delay, size))
        parameters, covariance = posterior(normal, prior, widths)
        if not with_memory:
            noise = [
                _left(one, parameters, covariance, delay, factor) for one, factor in zip(drives, inflation, strict=True)
            ]
    spread = np.zeros((size, size))
    for one, left in zip(drives, noise, strict=True):
        if left is not None:
            inside = np.ix_(one.rows.index, one.rows.index)
            spread[inside] += one.weight**2 * left.spread(one.factors, one.rows.segment)
    # Errors of the estimate: H^-1 (X^T W e - P (theta - mean)), of which the second part is H^-1 - H^-1 G H^-1
    sandwich = covariance @ (spread - normal.gram) @ covariance + covariance
    moved, delay_sigma = _delay_error(drives, normal, prior, covariance, delay, cutoff_hz) if find_delay else (0.0, 0.0)
    readings = sum(len(one) / left.memory for one, left in zip(rows, noise, strict=True) if left is not None)
    return Solution(
        parameters=parameters,
        covariance=sandwich + delay_sigma**2 * np.multiply.outer(moved, moved),
        prior_sigma=np.sqrt(np.sum(prior.factor(widths) ** 2, axis=1)),
        widths=widths,
        delay=delay,
        delay_sigma=delay_sigma,
        noise=tuple(noise),
        drives=drives,
        normal=normal,
        freedom=max(1.0, readings - float(np.sum(normal.gram * covariance))),
    )


def odds_against_none(solution: Solution, which: NDArray[np.intp]) -> float:
    """Return the logarithm of the odds that some parameters are there at all, to that they are none.

    They are those of the density at none before and after the data (J. M. Dickey, "The weighted likelihood ratio,
    linear hypotheses on normal location parameters", Annals of Mathematical Statistics 42(1), 1971).

    Args:
        solution: With covariances before and after the data.
        which: Indices of the parameters.
    """
    found, covariance = solution.parameters[which], solution.covariance[np.ix_(which, which)]
    narrower = float(np.linalg.slogdet(covariance)[1]) / 2 - float(np.sum(np.log(solution.prior_sigma[which])))
    return float(found @ np.linalg.solve(covariance, found)) / 2 + narrower


def _as_measured(rows: DriveRows) -> Noise | None:
    """Return all of the torque as noise: where the iteration begins."""
    return Noise(float(np.mean(rows.response(0.0) ** 2)), np.ones(1)) if len(rows) else None


def _weight(noise: Noise | None, with_memory: bool) -> float:
    if noise is None or noise.variance == 0:
        return 0.0
    return 1 / (noise.variance * (noise.memory if with_memory else 1.0))


def _left(drive: Weighed, parameters: Array, covariance: Array, delay: float, inflation: float) -> Noise | None:
    if not len(drive.rows):
        return None
    index = drive.rows.index
    residual = drive.rows.response(delay) - drive.rows.model(parameters)
    taken = drive.weight * float(np.sum((drive.factors @ covariance[np.ix_(index, index)]) * drive.factors))
    return noise_of(residual, drive.rows.segment, len(residual) - taken).inflated(inflation)


def _delay(drives: Sequence[Weighed], normal: Normal, prior: Prior, widths: Widths, cutoff_hz: float) -> float:
    """Return the delay with the largest posterior [s]; all delays within `LATEST` are as likely beforehand."""
    _, covariance = posterior(normal, prior, widths)
    most = LATEST / cutoff_hz

    def misfit(delay: float) -> float:
        return _misfit(drives, normal, prior, covariance, delay)

    tried = np.linspace(-most, most, DELAYS)
    best = int(np.argmin([misfit(delay) for delay in tried]))
    bounds = (tried[max(best - 1, 0)], tried[min(best + 1, DELAYS - 1)])
    return float(optimize.minimize_scalar(misfit, bounds=bounds, method="bounded", options={"xatol": FINE}).x)


def _misfit(drives: Sequence[Weighed], normal: Normal, prior: Prior, covariance: Array, delay: float) -> float:
    """Return minus twice the logarithm of the posterior of a delay, all parameters fitted, up to a constant."""
    size = len(prior.mean)
    squares = sum(one.weight * float(np.sum(one.response(delay) ** 2)) for one in drives)
    right = right_of(drives, delay, size)
    missing = right - normal.gram @ prior.mean
    return float(squares - 2 * right @ prior.mean - missing @ covariance @ missing)


def _delay_error(
    drives: Sequence[Weighed], normal: Normal, prior: Prior, covariance: Array, delay: float, cutoff_hz: float
) -> tuple[Array, float]:
    """Return how the parameters change with the delay, shape (p,) [1/s], and the delay's standard deviation [s]."""
    step = LATEST / cutoff_hz / (DELAYS - 1)
    ahead, here, back = (_misfit(drives, normal, prior, covariance, delay + k * step) for k in (1, 0, -1))
    curvature = (ahead - 2 * here + back) / step**2
    later, sooner = (right_of(drives, delay + k * step, len(prior.mean)) for k in (1, -1))
    sigma = np.sqrt(2 / curvature) if curvature > 0 else LATEST / cutoff_hz
    return covariance @ (later - sooner) / (2 * step), float(sigma)
