"""How long the residuals of a drive remember: what is left over is no white noise."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import matmul_toeplitz

from bench.record.campaign import Array

MOST_LAGS = 10  # effort: of the autoregression at most; its order is chosen by Akaike's criterion
NEARLY_ONE = 0.99  # effort: a pole nearer to the unit circle remembers more than 100 rows, which no data here tell


@dataclass(frozen=True)
class Noise:
    """Residuals of one drive as an autoregressive process.

    Attributes:
        variance: Of one row [Nm^2].
        correlation: Shape (K,), autocorrelation at lags 0, 1, ...
    """

    variance: float
    correlation: Array

    @property
    def memory(self) -> float:
        """How many rows count as one independent reading, at least 1: the sum over the autocorrelation."""
        return max(1.0, 2 * float(self.correlation.sum()) - 1)

    def inflated(self, factor: float) -> "Noise":
        """Return noise of `factor` times the variance."""
        return replace(self, variance=factor * self.variance)

    def spread(self, factors: Array, segment: NDArray[np.int64]) -> Array:
        """Return X^T S X, shape (q, q): covariance of X^T e for factors of shape (R, q)."""
        total = np.zeros((factors.shape[1],) * 2)
        for rows in pieces(segment):
            part = factors[rows]
            kernel = np.zeros(len(part))
            count = min(len(part), len(self.correlation))
            kernel[:count] = self.correlation[:count]
            total += part.T @ matmul_toeplitz((kernel, kernel), part)
        return np.asarray(self.variance * (total + total.T) / 2)


def noise_of(residual: Array, segment: NDArray[np.int64], freedom: float) -> Noise:
    """Return the noise of a drive's residuals.

    Args:
        residual: Shape (R,) [Nm].
        segment: Shape (R,), which uninterrupted piece of motion a row belongs to.
        freedom: Degrees of freedom that are left of the R.
    """
    variance = float(residual @ residual) / max(freedom, 1.0)
    rows = [residual[piece] for piece in pieces(segment)]
    longest = max(map(len, rows), default=0)
    target, past = _neighbours([row for row in rows if len(row) > MOST_LAGS])
    best, criterion = np.zeros(0), np.inf
    for order in range(min(MOST_LAGS, longest // 4) + 1):
        coefficients, innovation, count = _autoregression(target, past, order)
        if count and innovation > 0 and (value := count * np.log(innovation) + 2 * order) < criterion:
            best, criterion = coefficients, value
    return Noise(variance, _correlation(best, longest))


def pieces(segment: NDArray[np.int64]) -> list[slice]:
    """Return the rows of each uninterrupted piece of motion."""
    ends = np.concatenate([[0], np.flatnonzero(np.diff(segment)) + 1, [len(segment)]])
    return [slice(int(a), int(b)) for a, b in pairwise(ends) if b > a]


def _neighbours(rows: list[Array]) -> tuple[Array, Array]:
    """Return values of pieces of motion, shape (R,), and those at `MOST_LAGS` rows before each, shape (R, lags)."""
    if not rows:
        return np.zeros(0), np.zeros((0, MOST_LAGS))
    past = [np.stack([row[MOST_LAGS - k : len(row) - k] for k in range(1, MOST_LAGS + 1)], axis=1) for row in rows]
    return np.concatenate([row[MOST_LAGS:] for row in rows]), np.vstack(past)


def _autoregression(target: Array, past: Array, order: int) -> tuple[Array, float, int]:
    """Return coefficients, variance of the innovations, and number of rows; by least squares over all pieces.

    Args:
        target: Shape (R,).
        past: Shape (R, lags), what came before.
        order: How much of it counts.
    """
    if not len(target):
        return np.zeros(order), 0.0, 0
    if not order:
        return np.zeros(0), float(np.mean(target**2)), len(target)
    regressor = np.ascontiguousarray(past[:, :order])
    coefficients = np.asarray(np.linalg.lstsq(regressor, target)[0], dtype=np.float64)
    return coefficients, float(np.mean((target - regressor @ coefficients) ** 2)), len(target)


def _correlation(coefficients: Array, count: int) -> Array:
    """Return the autocorrelation of an autoregression at lags 0 to count - 1, poles drawn inside of `NEARLY_ONE`."""
    order = len(coefficients)
    if order == 0 or count < 2:
        return np.array([1.0, *np.zeros(max(count - 1, 0))])
    radius = float(np.abs(np.roots(np.concatenate([[1.0], -coefficients]))).max())
    shrink = min(1.0, NEARLY_ONE / radius) if radius > 0 else 1.0
    phi = coefficients * shrink ** np.arange(1, order + 1)
    equations, right = np.eye(order), phi.copy()  # Yule-Walker: rho_k = sum phi_i rho_|k - i|
    for k in range(1, order + 1):
        for i in range(1, order + 1):
            if i != k:
                equations[k - 1, abs(k - i) - 1] -= phi[i - 1]
    rho = np.concatenate([[1.0], np.linalg.solve(equations, right), np.zeros(max(0, count - order - 1))])[
        : max(count, 1)
    ]
    for k in range(order + 1, count):
        rho[k] = phi @ rho[k - order : k][::-1]
    return np.asarray(rho)
