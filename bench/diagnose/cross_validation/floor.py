"""The floor: how much a right model is expected to err in each reading, by the covariance that whitening undoes.

It is the expectation of what no model can predict, not a bound: noise and steps count as they are stated of the
instruments, and where friction and play come to rest has an assumed spread. An instrument that is better than stated,
and friction that came to rest nearer to the model than it may, leave less.
"""

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.noise_covariance import Whitening
from bench.record.campaign import Array


def measured(linear: LinearisedModel) -> NDArray[np.bool_]:
    """Return which entries count, shape (T, c)."""
    c = len(linear.quantities)
    return np.concatenate([whitening.rows.reshape(-1, c) for whitening in linear.whitenings])


def floor_variance(linear: LinearisedModel) -> Array:
    """Return the expected variance of what no model can predict, shape (T, c); nan where not measured.

    Noise of the instruments as stated, rests that swayed, and the assumed spread of static friction. What standard
    errors were raised by because no model fits (`linear.inflation`) is taken out: a poor model does not raise its own
    floor. So is what they were raised by where many readings were rounded to one number: each is no worse for that.
    """
    c = len(linear.quantities)
    parts = []
    for whitening, segment in zip(linear.whitenings, linear.weighed, strict=True):
        inflation = linear.inflation[0 if segment.is_static else 1]
        sigma = np.where(whitening.rows.reshape(-1, c), segment.sigma, 0.0)
        once = 0.0 if segment.counted_once is None else segment.counted_once
        parts.append(_variance_of(whitening, c) - sigma**2 * (1 - 1 / inflation**2) - once)
    for rests in linear.repeated:
        edges = np.cumsum([0, *(len(linear.whitenings[i].modes) for i in rests.segments)])
        power = np.sqrt(1 / (1 - rests.shrink) ** 2 - 1)
        for i, start, end in zip(rests.segments, edges[:-1], edges[1:], strict=True):
            common = linear.whitenings[i].undone(rests.modes[start:end] * power)
            parts[i] = parts[i] + np.sum(common**2, axis=2)
    return np.concatenate(parts)


def _variance_of(whitening: Whitening, c: int) -> Array:
    """Return the diagonal of the covariance that a whitening undoes, shape (T, c).

    A whitening is (I - U diag(1 - 1/sqrt(1 + s^2)) U^T) L^-1, so the covariance is L (I + U diag(s^2) U^T) L^T.
    """
    factors = np.linalg.inv(whitening.factors)
    modes = np.zeros((len(whitening.rows), whitening.modes.shape[1]))
    modes[whitening.rows] = whitening.modes
    shared = factors @ modes.reshape(len(factors), c, -1)
    power = 1 / (1 - whitening.shrink) ** 2 - 1
    variance = np.sum(factors**2, axis=2) + shared**2 @ power
    return np.where(whitening.rows.reshape(-1, c), variance, np.nan)
