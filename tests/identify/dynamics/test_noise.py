"""Residuals that remember: an autoregression of known memory, and its covariance against the definition."""

import numpy as np
from scipy import signal

from bench.identify.dynamics.noise import Noise, noise_of

POLE = 0.8


def test_memory_of_a_first_order_process(rng: np.random.Generator) -> None:
    white = rng.standard_normal(40_000) * np.sqrt(1 - POLE**2)
    residual = signal.lfilter([1.0], [1.0, -POLE], white)
    found = noise_of(residual, np.repeat(np.arange(4), 10_000), len(residual))
    np.testing.assert_allclose(found.variance, 1.0, rtol=0.1)
    np.testing.assert_allclose(found.memory, (1 + POLE) / (1 - POLE), rtol=0.1)


def test_white_residuals_remember_nothing(rng: np.random.Generator) -> None:
    found = noise_of(rng.standard_normal(5000), np.zeros(5000, dtype=np.int64), 5000)
    np.testing.assert_allclose(found.memory, 1.0, atol=0.1)


def test_spread_is_the_sum_over_all_pairs_of_rows_within_a_piece(rng: np.random.Generator) -> None:
    segment = np.repeat([0, 1], [30, 20])
    noise = Noise(2.5, POLE ** np.arange(30))
    lag = np.abs(np.subtract.outer(np.arange(50), np.arange(50)))
    same = np.equal.outer(segment, segment)
    covariance = 2.5 * np.where(same, POLE**lag, 0.0)
    factors = rng.standard_normal((50, 4))
    np.testing.assert_allclose(noise.spread(factors, segment), factors.T @ covariance @ factors, rtol=1e-10)


def test_pieces_too_short_for_a_memory_are_taken_as_white(rng: np.random.Generator) -> None:
    found = noise_of(rng.standard_normal(12), np.repeat(np.arange(6), 2), 12)
    assert found.memory == 1.0
