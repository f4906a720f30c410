"""Derivatives of motion whose samples are not evenly spaced, because a logger lost some of them."""

from math import factorial

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.smooth_derivative import DEGREE, smooth_derivative
from bench.record.campaign import Array
from bench.record.rules.clock import UNEVEN

ROWS = 4096  # effort: at a time; bounds the memory of their windows


def derivative_over(values: Array, time: Array, window: int, order: int) -> Array:
    """Return a derivative of columns over time, shape (n_rows, n) [1 / s^order of the values' unit].

    As `smooth_derivative` where samples are evenly spaced. Elsewhere a cubic is fitted to each sample and its
    neighbours at the times that they have; no window reaches over a gap that is longer than itself, unless what lies
    between two of them is shorter.

    Args:
        values: Shape (n_rows, n).
        time: Shape (n_rows,) [s], rising.
        window: Number of samples that one cubic is fitted to; odd, at most n_rows.
        order: Of the derivative, 1 or 2.
    """
    if is_even(time):
        return smooth_derivative(values, window, order, float(np.median(np.diff(time))))
    dt = float(np.median(np.diff(time)))
    first = _windows(time, window, window * dt)
    found = np.empty(values.shape)
    for begin in range(0, len(time), ROWS):
        rows = np.arange(begin, min(begin + ROWS, len(time)))
        inside = first[rows, None] + np.arange(window)
        away = time[inside] - time[rows, None]
        reach = np.max(np.abs(away), axis=1)
        powers = (away / reach[:, None])[:, :, None] ** np.arange(DEGREE + 1)
        weights = np.linalg.pinv(powers)[:, order, :] * (factorial(order) / reach**order)[:, None]
        found[rows] = np.einsum("rw,rwn->rn", weights, values[inside])
    return found


def is_even(time: Array) -> bool:
    """Return whether samples at times, shape (n_rows,), are evenly spaced; time stamps may round."""
    step = np.diff(time)
    dt = float(np.median(step))
    return not np.any(np.abs(step - dt) > UNEVEN * dt)


def _windows(time: Array, window: int, longest: float) -> NDArray[np.int64]:
    """Return the first sample of the window about each sample."""
    n = len(time)
    edges = np.concatenate([[0], np.flatnonzero(np.diff(time) > longest) + 1, [n]])
    part = np.searchsorted(edges, np.arange(n), side="right") - 1
    low, high = edges[part], edges[part + 1] - window
    centred = np.arange(n) - window // 2
    first = np.where(high >= low, np.clip(centred, low, np.maximum(high, low)), centred)
    return np.clip(first, 0, n - window).astype(np.int64)
