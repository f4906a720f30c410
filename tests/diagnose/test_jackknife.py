"""Standard errors by leaving out groups: against closed forms, and against estimates from many samples."""

import numpy as np
import pytest

from bench.diagnose.cross_validation.jackknife import jackknife_covariance, jackknife_variance
from bench.diagnose.cross_validation.leave_out import Tangent

GROUPS, EACH = 12, 20


def at_optimum(jacobian: np.ndarray, white: np.ndarray, prior: np.ndarray) -> Tangent:
    """Return a linear fit at its optimum, all parameters at their priors' centres before it."""
    precision = jacobian.T @ jacobian + np.diag(prior)
    value = np.linalg.solve(precision, jacobian.T @ white)
    left = white - jacobian @ value
    return Tangent(jacobian, left, precision, np.zeros(len(white)), np.arange(len(prior)), np.zeros(len(prior)))


def folds() -> tuple[np.ndarray, np.ndarray]:
    return np.repeat(np.arange(GROUPS), EACH), np.zeros((GROUPS * EACH, GROUPS), dtype=bool)


def test_of_a_mean_it_is_the_variance_of_means_of_groups() -> None:
    white = np.random.default_rng(0).standard_normal(GROUPS * EACH)
    tangent = at_optimum(np.ones((GROUPS * EACH, 1)), white, np.zeros(1))
    means = white.reshape(GROUPS, EACH).mean(axis=1)
    assert jackknife_variance(tangent, *folds())[0] == pytest.approx(np.var(means, ddof=1) / GROUPS)


def test_errors_that_groups_share_count_where_least_squares_does_not_see_them() -> None:
    rng, found, values = np.random.default_rng(1), [], []
    slope = rng.standard_normal((GROUPS * EACH, 1))
    slope += np.repeat(rng.standard_normal((GROUPS, 1)), EACH, axis=0)
    for _ in range(400):
        white = rng.standard_normal(GROUPS * EACH) + np.repeat(2 * rng.standard_normal(GROUPS), EACH)
        tangent = at_optimum(slope, white, np.zeros(1))
        found.append(jackknife_variance(tangent, *folds())[0])
        values.append((white - tangent.white) @ slope[:, 0] / (slope[:, 0] @ slope[:, 0]))
    true, stated = np.var(values), 1 / float(slope[:, 0] @ slope[:, 0])
    assert true > 10 * stated
    assert np.median(found) == pytest.approx(true, rel=0.5)


def test_what_a_prior_holds_back_keeps_the_variance_of_the_prior() -> None:
    jacobian = np.column_stack([np.ones(GROUPS * EACH), np.zeros(GROUPS * EACH)])
    tangent = at_optimum(jacobian, np.random.default_rng(2).standard_normal(GROUPS * EACH), np.array([0.0, 4.0]))
    assert jackknife_variance(tangent, *folds())[1] == pytest.approx(1 / 4)


def test_what_one_group_shows_alone_is_not_told_by_the_others() -> None:
    slope = np.zeros((GROUPS * EACH, 1))
    slope[:EACH] = 1.0
    tangent = at_optimum(slope, np.random.default_rng(3).standard_normal(GROUPS * EACH), np.ones(1))
    assert jackknife_variance(tangent, *folds())[0] == 0


def test_what_stands_for_one_another_moves_together() -> None:
    """A payload and the mass of its link were each as uncertain as runs disagree, and their sum as if neither was seen.

    So half a kilogram more was what the model had erred by, along the very motion that it was made of.
    """
    rng = np.random.default_rng(5)
    slope = np.ones((GROUPS * EACH, 2))
    slope[:, 1] += 0.3 * np.repeat(rng.standard_normal(GROUPS), EACH)
    white = rng.standard_normal(GROUPS * EACH) + np.repeat(2 * rng.standard_normal(GROUPS), EACH)
    tangent = at_optimum(slope, white, np.zeros(2))
    both = jackknife_covariance(tangent, *folds())
    np.testing.assert_allclose(np.diag(both), jackknife_variance(tangent, *folds()), rtol=1e-9)
    together = np.ones(2)
    assert together @ both @ together < 0.3 * np.trace(both)
    means = white.reshape(GROUPS, EACH).mean(axis=1)  # which the sum is the mean of, but for what the second adds
    assert together @ both @ together == pytest.approx(np.var(means, ddof=1) / GROUPS, rel=0.5)


def test_what_is_left_out_beside_a_block_does_not_count_as_scatter() -> None:
    rng, blocks, each = np.random.default_rng(4), 8, 40
    fold, place = np.repeat(np.arange(blocks), each), np.arange(blocks * each)
    gap = np.column_stack([(abs(place - (f + 0.5) * each) < 0.75 * each) & (fold != f) for f in range(blocks)])
    found = []
    for _ in range(400):
        tangent = at_optimum(np.ones((len(place), 1)), rng.standard_normal(len(place)), np.zeros(1))
        found.append(jackknife_variance(tangent, fold, gap)[0])
    assert np.mean(found) == pytest.approx(1 / len(place), rel=0.25)
