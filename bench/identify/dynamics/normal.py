"""Normal equations, and the posterior that a normal prior makes of them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg.lapack import dtrtrs

from bench.identify.dynamics.prior import Prior
from bench.identify.dynamics.rows import DriveRows
from bench.identify.dynamics.widths import AS_STATED, Widths
from bench.record.campaign import Array
from bench.robot.recent import Recent

MOST_FACTORS = 128  # effort: of priors, which are kept; about 0.2 MB each for six drives
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
    factor = _free_factor(prior, widths)  # what is not free stays
    inverse = _inverse(normal, factor)
    covariance = factor @ inverse @ factor.T
    return prior.mean + covariance @ (normal.right - normal.gram @ prior.mean), covariance


@dataclass(frozen=True, eq=False)
class Explained:
    """What widths of a prior make of data, of whose parameters r are free.

    Attributes:
        squares: Weighted, that they let parameters explain.
        volume: Half of log det H, with H = 1 + L^T G L = C C^T.
        free: Shape (p, r), the columns of L that are not zero.
        lower: Shape (r, r), C.
        reduced: Shape (r,), C^-1 L^T (X^T W y - G mean).
    """

    squares: float
    volume: float
    free: Array
    lower: Array
    reduced: Array

    def parameters(self, prior: Prior) -> Array:
        """Return the mean of the parameters, shape (p,)."""
        offset, _ = dtrtrs(self.lower.T, self.reduced, lower=0)
        return np.asarray(prior.mean + self.free @ offset)


def explained_by(normal: Normal, prior: Prior, widths: Widths) -> Explained:
    """Return what widths of a prior make of data; what is not free adds nothing to it."""
    free = _free_factor(prior, widths)
    inner = np.eye(free.shape[1]) + free.T @ normal.gram @ free
    lower = np.asarray(np.linalg.cholesky((inner + inner.T) / 2), dtype=np.float64)
    right = free.T @ (normal.right - normal.gram @ prior.mean)
    reduced, _ = dtrtrs(lower.T, right, lower=0, trans=1)
    return Explained(float(reduced @ reduced), float(np.log(np.diag(lower)).sum()), free, lower, reduced)


def log_evidence(normal: Normal, prior: Prior, widths: Widths) -> float:
    """Return the logarithm of the marginal likelihood up to what no width changes.

    With H = 1 + L^T G L and b = L^T (X^T W y - G mean): (b^T H^-1 b - log det H) / 2.
    """
    found = explained_by(normal, prior, widths)
    return found.squares / 2 - found.volume


def evidence_gain(before: Explained, after: Explained, readings: float, left: float) -> float:
    """Return by how much other widths raise the log evidence where nobody knows the noise of one drive.

    Weights hold what widths `before` leave of it for noise, so what `after` explains of it can raise the evidence by
    half its readings at most, though it leave next to nothing. With the noise that is left, squares S0 that become S1
    count (n - 1) / 2 log(S0 / S1), as in Student's t. What other drives and the prior gain counts as what is explained
    of it, and by half where that would be all of it.

    Args:
        before: What widths make of data that the weights belong to.
        after: What those make of them that are tried.
        readings: n, of the drive that is explained: its weighted squares before, one by one as independent ones count.
        left: Its weighted squares after.
    """
    explained, volume = after.squares - before.squares, after.volume - before.volume
    elsewhere = 0.0
    if explained >= readings > left > 0:
        explained, elsewhere = readings - left, explained - (readings - left)
    if not 0 < explained < readings:
        return explained / 2 - volume
    return elsewhere / 2 - max(readings - 1, 0.0) / 2 * float(np.log1p(-explained / readings)) - volume


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


_FACTORS: Recent[tuple[Prior, Widths], Array] = Recent(MOST_FACTORS)


def _free_factor(prior: Prior, widths: Widths) -> Array:
    """Return the columns of L that are not zero, shape (p, r); the same widths are weighed again and again."""

    def made() -> Array:
        factor = prior.factor(widths)
        factor = factor[:, np.any(factor, axis=0)]
        factor.flags.writeable = False
        return factor

    return _FACTORS.get((prior, widths), made)


def _inverse(normal: Normal, factor: Array) -> Array:
    inner = np.eye(factor.shape[1]) + factor.T @ normal.gram @ factor
    return np.asarray(np.linalg.inv((inner + inner.T) / 2))
