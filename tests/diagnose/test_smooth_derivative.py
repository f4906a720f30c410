"""Derivatives of sampled motion: exact for cubics, and the same as SciPy's filter."""

import numpy as np
import pytest
from scipy.signal import savgol_filter

from bench.diagnose.replay.smooth_derivative import averaging_kernel, noise_gain, smooth_derivative

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
    if order == 2:  # and beyond the windows of the ends, what second differences leave out between samples
        inside = slice(window // 2, rows - window // 2)
        expected[inside][1:-1] -= np.diff(expected[inside], 2, axis=0) / 12
    found = smooth_derivative(values, window, order, DT)
    np.testing.assert_allclose(found, expected, rtol=0, atol=ROUNDING * np.abs(expected).max())


@pytest.mark.parametrize("window", [5, 7])
def test_coarse_samples_tell_the_acceleration_at_their_instants(window: int) -> None:
    """Averaged alike, both are the same to a part in ten thousand; a plain second difference is off by a hundredth."""
    time, step = 0.02 * np.arange(400), 0.02
    omega = 2 * np.pi * 3.0
    acceleration = -(omega**2) * np.sin(omega * time)
    found = smooth_derivative(np.sin(omega * time)[:, None], window, 2, step)[:, 0]
    kernel, inside = averaging_kernel(window), slice(window, -window)
    averaged = np.convolve(acceleration, kernel, mode="same")
    error = np.abs(found - averaged)[inside].max() / np.abs(averaged[inside]).max()
    plain = np.convolve(np.diff(np.sin(omega * time), 2, prepend=0, append=0) / step**2, kernel, mode="same")
    assert error < 3e-4
    assert np.abs(plain - averaged)[inside].max() > 0.01 * np.abs(averaged[inside]).max()


@pytest.mark.parametrize("window", [5, 15])
@pytest.mark.parametrize("order", [1, 2])
def test_noise_gain_is_that_of_white_noise(window: int, order: int) -> None:
    noise = np.random.default_rng(2).normal(size=(40_000, 1))
    inside = slice(window, -window)
    found = float(smooth_derivative(noise, window, order, 1.0)[inside].std())
    assert found == pytest.approx(noise_gain(window, order), rel=0.02)
