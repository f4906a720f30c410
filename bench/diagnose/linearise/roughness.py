"""What is not resolved is noise: standard errors where the residual of a motion is rough."""

from functools import lru_cache

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.special import chdtri

from bench.record.campaign import Array

# assumed: bins, over which the roughness of a residual is averaged: some five degrees of freedom, a second or two
WINDOW = 9
BY_CHANCE = 0.05  # declared: share of white noise that counts as rough


def with_roughness(left: Array, sigma: Array) -> Array:
    """Return the standard errors of one motion, raised to the roughness of its residuals, both shape (T, c).

    Where a channel is not compared, as where its drive turns round (nan), it has no neighbours: each stretch between
    is looked at by itself.
    """
    raised = sigma.copy()
    for c in range(left.shape[1]):
        edges = np.flatnonzero(np.diff(np.isfinite(left[:, c]), prepend=False, append=False))
        for start, end in edges.reshape(-1, 2):
            raised[start:end, c] = _raised(left[start:end, c], sigma[start:end, c])
    return raised


def _raised(left: Array, sigma: Array) -> Array:
    """Return the standard errors of readings that follow one another, raised to the roughness of their residuals."""
    window = min(WINDOW, len(left) - 2)
    if window < 1:
        return sigma
    second = np.pad(np.diff(left, 2) ** 2 / 6, 1, mode="edge")  # of white noise: its variance
    local = np.maximum(uniform_filter1d(second, window, mode="nearest"), 0.0)  # its running sum may round below
    return np.where(local > most_by_chance(window) * sigma**2, np.sqrt(local), sigma)


@lru_cache
def most_by_chance(window: int) -> float:
    """Return up to what the mean of squared second differences of white noise comes by chance, in shares of their mean.

    Second differences are correlated by -2/3 with their neighbours and by 1/6 with the next ones. So the mean of
    `window` squares scatters as one of 1.8 times fewer does that are independent (Satterthwaite, 1946).
    """
    correlations = np.array([2 / 3, 1 / 6])[: window - 1]
    lags = np.arange(1, len(correlations) + 1)
    degrees = window / (1 + 2 * float(np.sum((1 - lags / window) * correlations**2)))
    return float(chdtri(degrees, BY_CHANCE)) / degrees
