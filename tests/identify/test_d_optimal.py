"""D-optimal choice against designs known in closed form and against exhaustive search."""

from itertools import combinations

import numpy as np
import pytest

from bench.errors import InputError
from bench.identify.d_optimal import choose, log_determinant

WEAK = 1e-6  # prior, against an information of order 1


def information(rows):
    return rows[:, :, None] * rows[:, None, :]


def free(count):
    return np.zeros(count, dtype=bool)


@pytest.mark.parametrize(
    ("degree", "expected"),
    [(1, [-1, 1]), (2, [-1, 0, 1]), (3, [-1, -np.sqrt(1 / 5), np.sqrt(1 / 5), 1])],
)
def test_polynomial_regression(rng, degree, expected):
    """D-optimal for a polynomial on [-1, 1]: the ends and the zeros of P'_degree (Fedorov 1972, theorem 2.3.3)."""
    x = np.unique(np.concatenate([np.linspace(-1, 1, 201), expected]))
    candidates = information(np.vander(x, degree + 1))
    chosen = choose(candidates, WEAK * np.eye(degree + 1), degree + 1, degree + 1, free(len(x)), 0, rng, starts=2)
    np.testing.assert_allclose(x[chosen], expected, atol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_finds_what_exhaustive_search_finds(seed):
    rng = np.random.default_rng(seed)
    candidates, prior = information(rng.standard_normal((14, 3))), WEAK * np.eye(3)
    limited = np.arange(14) < 5
    allowed = [c for c in combinations(range(14), 4) if limited[list(c)].sum() <= 1]
    value = {c: log_determinant(prior + candidates[list(c)].sum(axis=0), 3) for c in allowed}
    chosen = choose(candidates, prior, 3, 4, limited, 1, rng, starts=8)
    assert tuple(chosen.tolist()) == max(value, key=value.get)


def test_nuisances_are_taken_as_unknown(rng):
    """The determinant that counts is that of the inverse covariance of the parameters of interest."""
    root = rng.standard_normal((9, 5))
    total = root.T @ root
    covariance = np.linalg.inv(total)[:3, :3]
    assert log_determinant(total, 3) == pytest.approx(-np.linalg.slogdet(covariance)[1], abs=1e-9)


def test_limit_and_shortage(rng):
    candidates, prior = information(rng.standard_normal((6, 2))), np.eye(2)
    every = np.ones(6, dtype=bool)
    assert len(choose(candidates, prior, 2, 3, every, 3, rng, starts=1)) == 3
    with pytest.raises(InputError, match="2 candidates can be chosen, which is not enough for 3"):
        choose(candidates, prior, 2, 3, every, 2, rng, starts=1)
