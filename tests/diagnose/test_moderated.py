"""How far runs differ, where two runs of each of many channels say it together: intervals cover and are narrow."""

import numpy as np
import pytest
from scipy.special import stdtrit

from bench.diagnose.cross_validation.moderated import moderated
from bench.record.campaign import Array

CHANNELS = 400
SPREAD = 0.2  # of logarithms
HIGH = 0.95


def runs_of(rng: np.random.Generator, spreads: Array, count: int) -> list[Array]:
    return [np.exp(spread * rng.standard_normal(count)) for spread in spreads]


def half_widths(student: tuple[tuple[float, float], ...]) -> Array:
    return np.array([stdtrit(min(degrees, 1e6), HIGH) * spread for spread, degrees in student])


@pytest.mark.parametrize("alike", [np.inf, 4.0])
@pytest.mark.parametrize("count", [2, 8])
def test_intervals_cover_one_more_run(alike: float, count: int, rng: np.random.Generator) -> None:
    scatter = np.ones(CHANNELS) if np.isinf(alike) else alike / rng.chisquare(alike, CHANNELS)
    spreads = SPREAD * np.sqrt(scatter)
    rms = runs_of(rng, spreads, count)
    half = half_widths(moderated(rms)) * np.sqrt(1 + 1 / count)
    fresh = spreads * rng.standard_normal(CHANNELS)
    mean = np.array([np.log(one).mean() for one in rms])
    kept = float(np.mean(np.abs(fresh - mean) < half))
    assert kept == pytest.approx(0.9, abs=3 * np.sqrt(0.9 * 0.1 / CHANNELS))
    alone = np.array([np.log(one).std(ddof=1) for one in rms]) * stdtrit(count - 1, HIGH) * np.sqrt(1 + 1 / count)
    assert np.quantile(half, 0.9) < np.quantile(alone, 0.9) / (2 if count == 2 else 1), "what it is for"


def test_channels_that_are_alike_have_one_spread(rng: np.random.Generator) -> None:
    found = moderated(runs_of(rng, np.full(CHANNELS, SPREAD), 3))
    spreads = np.array([spread for spread, _ in found])
    assert spreads == pytest.approx(SPREAD, rel=0.25)


def test_a_channel_alone_stands_for_itself() -> None:
    rms = np.exp(np.array([0.1, -0.2, 0.4]))
    ((spread, degrees),) = moderated([rms])
    assert spread == pytest.approx(np.log(rms).std(ddof=1))
    assert degrees == 2


def test_one_run_of_a_channel_is_told_by_the_others_and_alone_by_nobody(rng: np.random.Generator) -> None:
    assert np.all(np.isnan(moderated([np.ones(1), np.ones(1)])))
    *_, (spread, degrees) = moderated([*runs_of(rng, np.full(CHANNELS, SPREAD), 2), np.ones(1)])
    assert spread == pytest.approx(SPREAD, rel=0.25)
    assert degrees > 10


def test_runs_that_are_equal_by_chance_do_not_count_for_nothing(rng: np.random.Generator) -> None:
    found = moderated([*runs_of(rng, np.full(20, SPREAD), 2), np.ones(2)])
    assert all(np.isfinite(spread) and spread > 0 for spread, _ in found)
