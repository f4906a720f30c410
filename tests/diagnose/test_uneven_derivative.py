"""Derivatives where samples were lost: exact for cubics, as the even ones elsewhere, and local at gaps."""

import numpy as np
import pytest

from bench.diagnose.replay.smooth_derivative import smooth_derivative
from bench.diagnose.replay.uneven_derivative import derivative_over

DT = 0.004  # [s]
WINDOW = 15
ROUNDING = 1e-12  # of values that are divided by dt^order
CUBIC = np.polynomial.Polynomial([0.3, -1.0, 2.0, 5.0])


@pytest.mark.parametrize("order", [1, 2])
def test_cubics_are_exact_though_a_fifth_of_the_samples_is_lost(order: int, rng: np.random.Generator) -> None:
    time = DT * np.flatnonzero(rng.random(600) > 0.2)
    found = derivative_over(CUBIC(time)[:, None], time, WINDOW, order)[:, 0]
    expected = CUBIC.deriv(order)(time)
    np.testing.assert_allclose(found, expected, rtol=0, atol=ROUNDING * np.abs(CUBIC(time)).max() / DT**order)


@pytest.mark.parametrize("order", [1, 2])
def test_even_samples_go_the_fast_way(order: int, rng: np.random.Generator) -> None:
    values = np.cumsum(rng.normal(size=(300, 2)), axis=0)
    found = derivative_over(values, DT * np.arange(300), WINDOW, order)
    np.testing.assert_allclose(found, smooth_derivative(values, WINDOW, order, DT), rtol=1e-6, atol=1e-6)


def test_nothing_is_seen_through_a_long_gap() -> None:
    """A joint that stands before a gap and elsewhere after it stands on both sides."""
    time = DT * np.concatenate([np.arange(100), 2000 + np.arange(100)])
    values = np.where(time < 1, 0.5, 1.5)[:, None]
    assert np.abs(derivative_over(values, time, WINDOW, 1)).max() < 1e-9
