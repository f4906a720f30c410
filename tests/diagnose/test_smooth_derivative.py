"""Derivatives of sampled motion: exact for cubics, and the same as SciPy's filter."""

import numpy as np
import pytest
from scipy.signal import savgol_filter

from bench.diagnose.replay.smooth_derivative import smooth_derivative

DT = 0.004  # [s]
ROUNDING = 1e-11  # of the largest value; a second derivative divides differences of rounded numbers by dt^2


@pytest.mark.parametrize("order", [1, 2])
def test_cubics_are_exact_to_the_edges(order: int) -> None:
    time = DT * np.arange(30)
    polynomial = np.polynomial.Polynomial([0.3, -1.0, 2.0, 5.0])
    found = smooth_derivative(polynomial(time)[:, None], 9, order, DT)[:, 0]
    np.testing.assert_allclose(found, polynomial.deriv(order)(time), rtol=0, atol=1e-8)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(("rows", "window"), [(5, 5), (9, 9), (200, 15), (200, 199), (1000, 301)])
def test_it_is_scipys_filter(order: int, rows: int, window: int) -> None:
    values = np.cumsum(np.random.default_rng(1).normal(size=(rows, 3)), axis=0)
    expected = savgol_filter(values, window, 3, deriv=order, delta=DT, axis=0, mode="interp")
    found = smooth_derivative(values, window, order, DT)
    np.testing.assert_allclose(found, expected, rtol=0, atol=ROUNDING * np.abs(expected).max())
