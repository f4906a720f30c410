"""What is known of sizes, and what it says of causes that act alike."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import logsumexp

from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.marginal import log_evidences_of
from bench.diagnose.linearise.screening import widths_of
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE

DRAWS = 20_000
SIGMA = 1e-4
MOST_MISSED = 0.15  # of a probability: some normal priors are no uniform one; one normal prior misses 0.2 to 0.5


def cause_of(low: float, high: float) -> Cause:
    effect = catalogue()["drive_delay"]
    return Cause(effect, WHOLE, (replace(effect.parameters[0], low=low, high=high),), ())


def log_evidence(seen: np.ndarray, high: float, widths: tuple[float, ...]) -> np.ndarray:
    each = []
    for width in widths:
        prior = width * high / np.sqrt(3)
        information = np.full((len(seen), 1, 1), SIGMA**-2 + prior**-2)
        each.append(log_evidences_of(information, seen[:, None] / SIGMA**2, np.full((len(seen), 1), prior)))
    return np.asarray(logsumexp(each, axis=0) - np.log(len(widths)))


@pytest.mark.parametrize("second", [(0.1, 0.5), (0.01, 0.15), (0.005, 0.05), (0.5, 50.0)])
def test_twins_are_told_as_often_as_is_said(rng: np.random.Generator, second: tuple[float, float]) -> None:
    """A torque of a few per cent of its range was an offset of a current at 0.9, ten times of twelve (messy arms)."""
    ranges = (0.01, 1.0), second
    is_first = rng.random(DRAWS) < 0.5
    low, high = (np.where(is_first, *ends) for ends in zip(*ranges, strict=True))
    size = np.exp(rng.uniform(np.log(low), np.log(high))) * rng.choice([-1, 1], DRAWS)
    seen = size + SIGMA * rng.standard_normal(DRAWS)

    def told(*widths: tuple[float, ...]) -> np.ndarray:
        first, other = (log_evidence(seen, one[1], mine) for one, mine in zip(ranges, widths, strict=True))
        return np.asarray(np.exp(first - np.logaddexp(first, other)))

    def score(told: np.ndarray) -> float:
        return float(np.mean(np.log(np.where(is_first, told, 1 - told))))

    wide = told(*(widths_of(cause_of(*one)) for one in ranges))
    inside = [(np.abs(seen) > low) & (np.abs(seen) < high) for low, high in ranges]
    either = inside[0] & inside[1]
    assert wide[either].mean() == pytest.approx(is_first[either].mean(), abs=MOST_MISSED)
    assert score(wide) > score(told((1.0,), (1.0,))) + 0.05
