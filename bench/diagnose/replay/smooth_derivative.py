"""Derivatives of sampled motion by cubic polynomials through a window of samples (Savitzky and Golay, 1964).

The first is that of `scipy.signal.savgol_filter` with mode "interp", which makes its polynomials anew in each call. The
second makes good for what lies between samples: a second difference is an average of the acceleration over two steps,
a + dt^2 a''/12, while a torque is read at its instants. Without that term (Numerov's) it is a second difference of
fourth order, -1 16 -30 16 -1 over 12, in the same average. It counts where a window has few samples: on a noise-free
log of 50 Hz a tenth of what a replay misses, for noise of accelerations that is a sixth larger.
"""

from functools import lru_cache
from math import factorial

import numpy as np
from scipy.ndimage import correlate1d

from bench.record.campaign import Array

DEGREE = 3  # exact: of the polynomials, which follow a curvature that changes
NUMEROV = 1 / 12  # exact: of its second difference, by which a second difference exceeds an acceleration


def smooth_derivative(values: Array, window: int, order: int, dt: float) -> Array:
    """Return a derivative of columns over time, shape (n_rows, n) [1 / s^order of the values' unit].

    Args:
        values: Shape (n_rows, n), equidistant samples.
        window: Number of samples that one cubic goes through; odd, at most n_rows.
        order: Of the derivative, 1 or 2.
        dt: Between samples [s].
    """
    weights, half = _weights(window, order), window // 2
    found: Array = correlate1d(values, weights[half], axis=0, mode="constant")
    found[:half] = weights[:half] @ values[:window]
    found[len(values) - half :] = weights[half + 1 :] @ values[-window:]
    if order == 2:
        found[half + 1 : len(found) - half - 1] -= np.diff(found[half : len(found) - half], 2, axis=0) * NUMEROV
    return found / dt**order


def averaging_kernel(window: int) -> Array:
    """Return the weights with which a second derivative averages the acceleration, shape (window - 2,); their sum is 1.

    A second derivative is a weighted sum of accelerations at the samples. What is linear in acceleration, such as a
    torque, averaged with the same weights goes with it, however fast both change.

    Args:
        window: Number of samples that one cubic goes through.
    """
    return np.asarray(np.cumsum(np.cumsum(_weights(window, 2)[window // 2]))[:-2])


def noise_gain(window: int, order: int) -> float:
    """Return the standard deviation of a derivative, away from the ends, for white noise of 1 and samples 1 s apart.

    Args:
        window: Number of samples that one cubic goes through.
        order: Of the derivative.
    """
    weights = _weights(window, order)[window // 2]
    if order == 2:
        weights = np.convolve(weights, [-NUMEROV, 1 + 2 * NUMEROV, -NUMEROV])
    return float(np.linalg.norm(weights))


@lru_cache(maxsize=256)
def _weights(window: int, order: int) -> Array:
    """Return what makes the derivative at each sample of a window out of its samples, shape (window, window)."""
    half = window // 2
    places = np.arange(-half, half + 1) / half  # powers of numbers up to 1 keep the problem well conditioned
    powers = np.arange(order, DEGREE + 1)
    derivative = np.zeros((window, DEGREE + 1))
    derivative[:, order:] = places[:, None] ** (powers - order) * [factorial(k) // factorial(k - order) for k in powers]
    weights: Array = derivative @ np.linalg.pinv(np.vander(places, DEGREE + 1, increasing=True)) / half**order
    return weights
