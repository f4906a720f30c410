"""Normal equations, and the posterior that a normal prior makes of them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_triangular

from bench.identify.dynamics.prior import AS_STATED, Prior, Widths
from bench.identify.dynamics.rows import DriveRows
from bench.record.campaign import Array

ROUNDING = 1e-12  # rounding: of a sum of squares; what is left below that when its terms are taken away again


@dataclass(frozen=True)
class Normal:
    """Sums over rows, weighted.

    Attributes:
        gram: Shape (p, p), X^T W X.
        right: Shape (p,), X^T W y.
    """

    gram: Array
    right: Array

    def __sub__(self, other: "Normal") -> "Normal":
        """Return the sums without some of their rows; what only those showed is not told by rounding errors."""
        gram = self.gram - other.gram
        shown = np.diag(gram) > ROUNDING * np.diag(self.gram)
        return Normal(np.where(np.outer(shown, shown), gram, 0.0), np.where(shown, self.right - other.right, 0.0))


@dataclass(frozen=True)
class Weighed:
    """The rows of one drive with their factors about given parameters, and what each row counts.

    Attributes:
        rows: Of the drive.
        factors: Shape (R, q).
        beyond: Shape (R,) [Nm], what they make of these parameters beyond the model.
        weight: [1/Nm^2]; 0: the drive is left out.
    """

    rows: DriveRows
    factors: Array
    beyond: Array
    weight: float

    @classmethod
    def about(cls, rows: DriveRows, parameters: Array, weight: float) -> "Weighed":
        """Return rows linearised about parameters, shape (p,)."""
        return cls(rows, rows.factors(parameters), rows.twice(parameters), weight)

    def response(self, delay: float) -> Array:
        """Return what the factors explain, shape (R,) [Nm], of torques read `delay` [s] later than the angles."""
        return self.rows.response(delay) + self.beyond


def normal_of(drives: Sequence[Weighed], delay: float, size: int) -> Normal:
    """Return the normal equations of `size` parameters with torques read `delay` [s] late."""
    gram = np.zeros((size, size))
    for one in drives:
        gram[np.ix_(one.rows.index, one.rows.index)] += one.weight * one.factors.T @ one.factors
    return Normal(gram, right_of(drives, delay, size))


def right_of(drives: Sequence[Weighed], delay: float, size: int) -> Array:
    """Return X^T W y alone, shape (p,)."""
    right = np.zeros(size)
    for one in drives:
        right[one.rows.index] += one.weight * one.factors.T @ one.response(delay)
    return right


def posterior(normal: Normal, prior: Prior, widths: Widths) -> tuple[Array, Array]:
    """Return mean, shape (p,), and covariance, shape (p, p), of the parameters."""
    factor = prior.factor(widths)
    factor = factor[:, np.any(factor, axis=0)]  # what is not free stays
    inverse = _inverse(normal, factor)
    covariance = factor @ inverse @ factor.T
    return prior.mean + covariance @ (normal.right - normal.gram @ prior.mean), covariance


def log_evidence(normal: Normal, prior: Prior, widths: Widths) -> float:
    """Return the logarithm of the marginal likelihood up to what no width changes.

    With H = 1 + L^T G L and b = L^T (X^T W y - G mean): (b^T H^-1 b - log det H) / 2.
    """
    explained, volume = _evidence(normal, prior, widths)
    return explained / 2 - volume


def evidence_gain(normal: Normal, prior: Prior, before: Widths, after: Widths, readings: float, left: float) -> float:
    """Return by how much other widths raise the log evidence where nobody knows the noise of one drive.

    Weights hold what widths `before` leave of it for noise, so what `after` explains of it can raise the evidence by
    half its readings at most, though it leave next to nothing. With the noise that is left, squares S0 that become S1
    count (n - 1) / 2 log(S0 / S1), as in Student's t. What other drives and the prior gain counts as what is explained
    of it, and by half where that would be all of it.

    Args:
        normal: The normal equations, weighted by the noise before.
        prior: Of the parameters.
        before: Widths that the weights belong to.
        after: Widths that are tried.
        readings: n, of the drive that is explained: its weighted squares before, one by one as independent ones count.
        left: Its weighted squares after.
    """
    first, volume = _evidence(normal, prior, before)
    second, other = _evidence(normal, prior, after)
    explained, volume = second - first, other - volume
    elsewhere = 0.0
    if explained >= readings > left > 0:
        explained, elsewhere = readings - left, explained - (readings - left)
    if not 0 < explained < readings:
        return explained / 2 - volume
    return elsewhere / 2 - max(readings - 1, 0.0) / 2 * float(np.log1p(-explained / readings)) - volume


def _evidence(normal: Normal, prior: Prior, widths: Widths) -> tuple[float, float]:
    """Return the weighted squares that a prior lets parameters explain, and half its log det H."""
    factor = prior.factor(widths)
    factor = factor[:, np.any(factor, axis=0)]  # what is not free adds nothing to either
    inner = np.eye(factor.shape[1]) + factor.T @ normal.gram @ factor
    lower = np.linalg.cholesky((inner + inner.T) / 2)
    right = factor.T @ (normal.right - normal.gram @ prior.mean)
    explained = solve_triangular(lower, right, lower=True, check_finite=False)
    return float(explained @ explained), float(np.log(np.diag(lower)).sum())


def likeliest_widths(normal: Normal, prior: Prior, best: Widths) -> Widths:
    """Return the widths of the prior with the most evidence, changing one after the other until none gains."""
    value = log_evidence(normal, prior, best)
    while True:
        tried = [(log_evidence(normal, prior, widths), widths) for widths in best.neighbours()]
        top, widths = max(tried, key=lambda pair: pair[0])
        if not top > value:
            return best
        best, value = widths, top


def width_errors(normal: Normal, prior: Prior, chosen: Widths) -> Array:
    """Return what the covariance of the parameters lacks because one set of widths was chosen, shape (p, p).

    Each width is varied alone, and each value counts by its evidence. Of wider ones the larger covariance and the other
    mean are counted (law of total variance). Where data do not tell a parameter they do not tell its width either: then
    the narrowest would claim to know it. Scales of torques are as uncertain as stated, whatever was chosen.
    """
    mean, covariance = posterior(normal, prior, chosen)
    other, wider = posterior(normal, prior, replace(chosen, scale=AS_STATED))
    added = wider - covariance + np.multiply.outer(other - mean, other - mean)
    for line in chosen.lines():
        evidence = np.array([log_evidence(normal, prior, widths) for widths in line])
        share = np.exp(evidence - evidence.max())
        share /= share.sum()
        for widths, weight in zip(line, share, strict=True):
            if weight > ROUNDING and widths.wider_than(chosen):
                other, wider = posterior(normal, prior, widths)
                added += weight * (wider - covariance + np.multiply.outer(other - mean, other - mean))
    return added


def _inverse(normal: Normal, factor: Array) -> Array:
    inner = np.eye(factor.shape[1]) + factor.T @ normal.gram @ factor
    return np.asarray(np.linalg.inv((inner + inner.T) / 2))
