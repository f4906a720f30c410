"""Runs that are left out: folds, and their algebra against dense normal densities and fits without them."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from bench.diagnose.cross_validation.folds import folds_of
from bench.diagnose.cross_validation.leave_out import (
    errors_of_folds,
    log_probability_of_figures,
    log_probability_of_folds,
    tangent_of,
)
from bench.record.held_out import BLOCKS
from tests.diagnose.made_runs import LENGTH, SIGMA, UNKNOWN, design_with, fit_of, in_recordings, noise, sensitivities


def test_held_out_runs_have_their_conditional_normal_density(rng: np.random.Generator) -> None:
    runs = 5
    linear = design_with(noise(rng, runs), sensitivities(rng, runs), runs)
    column = rng.standard_normal(runs * LENGTH)
    fit = fit_of(linear, column)
    tangent = tangent_of(linear, fit)
    found = log_probability_of_folds(linear, tangent, folds_of(linear))
    prior = np.diag([1.0, 1.0, 1.0, UNKNOWN.sigma**2])
    covariance = np.eye(len(linear.white)) + tangent.jacobian @ prior @ tangent.jacobian.T
    everything = multivariate_normal.logpdf(linear.white, cov=covariance)
    for f in range(runs):
        rest = linear.run_of != f
        others = multivariate_normal.logpdf(linear.white[rest], cov=covariance[np.ix_(rest, rest)])
        assert found[f] == pytest.approx(everything - others - LENGTH * np.log(SIGMA), abs=1e-6)


def test_a_held_out_figure_has_its_conditional_normal_density(rng: np.random.Generator) -> None:
    linear = design_with(noise(rng, 4) + 0.5, sensitivities(rng, 4), 4)
    fit = fit_of(linear)
    p = 3
    # the stated figures are measurements 0 = x + e of the same parameters x, flat otherwise
    jacobian = np.concatenate([linear.jacobian, np.eye(p)])
    seen = np.concatenate([linear.white, np.zeros(p)])
    expected = 0.0
    for i in range(p):
        rest = np.arange(len(seen)) != len(linear.white) + i
        precision = jacobian[rest].T @ jacobian[rest]
        mean = np.linalg.solve(precision, jacobian[rest].T @ seen[rest])[i]
        variance = 1 + np.linalg.inv(precision)[i, i]
        expected += -0.5 * (mean**2 / variance + np.log(variance))
    assert log_probability_of_figures(fit, tangent_of(linear, fit)) == pytest.approx(expected)


def test_held_out_error_is_that_of_a_fit_without_the_run(rng: np.random.Generator) -> None:
    runs = 5
    jacobian, column = sensitivities(rng, runs), rng.standard_normal(runs * LENGTH)
    residual = noise(rng, runs) + jacobian @ np.array([1.0, -1.0, 0.5])
    linear = design_with(residual, jacobian, runs)
    fit = fit_of(linear, column)
    found = errors_of_folds(linear, fit, tangent_of(linear, fit), folds_of(linear))
    for f in range(runs):
        stays = np.repeat(np.arange(runs), LENGTH) != f
        without = design_with(residual[stays], jacobian[stays], runs - 1)
        refitted = fit_of(without, column[stays])
        expected = residual - jacobian @ refitted.nuisances - column * refitted.values[0]
        np.testing.assert_allclose(found[~stays, 0], expected[~stays], atol=1e-9)


def test_what_is_a_recordings_own_is_fitted_to_it_and_the_rest_to_the_others(rng: np.random.Generator) -> None:
    """Of five recordings each has a zero of its own; the machine has two figures, and one size."""
    runs = 5
    run = np.repeat(np.arange(runs), LENGTH)
    shared, column = sensitivities(rng, runs, p=2), rng.standard_normal(runs * LENGTH)
    zeros = 2.0 * (run[:, None] == np.arange(runs))
    jacobian = np.concatenate([shared, zeros], axis=1)
    residual = noise(rng, runs) + shared @ np.array([1.0, -0.5]) + zeros @ rng.standard_normal(runs) + 0.1 * column
    linear = in_recordings(design_with(residual, jacobian, runs), (None, None, *(f"run{i}" for i in range(runs))))
    fit = fit_of(linear, column)
    folds = folds_of(linear)
    assert folds.recordings == linear.runs
    found = errors_of_folds(linear, fit, tangent_of(linear, fit), folds)
    for f in range(runs):
        stays = run != f
        machine = fit_of(design_with(residual[stays], jacobian[stays], runs - 1), column[stays])
        left = (residual - shared @ machine.nuisances[:2] - column * machine.values[0])[~stays]
        own = zeros[~stays, f]
        zero = own @ left / (own @ own + SIGMA**2)  # its prior has the width of one
        np.testing.assert_allclose(found[~stays, 0], left - own * zero, atol=1e-9)


def test_figures_stay_within_reach(rng: np.random.Generator) -> None:
    jacobian = sensitivities(rng, 4, p=1)
    linear = design_with(noise(rng, 4) + 10 * jacobian[:, 0], jacobian, 4)
    fit = fit_of(linear)
    assert abs(fit.nuisances[0]) > 8  # else the test says nothing
    found = errors_of_folds(linear, fit, tangent_of(linear, fit), folds_of(linear))
    np.testing.assert_allclose(found[:, 0], linear.residual[:, 0] - 4 * jacobian[:, 0], atol=1e-9)


def test_folds_are_whole_runs(rng: np.random.Generator) -> None:
    linear = design_with(noise(rng, 50), sensitivities(rng, 50), 50)
    folds = folds_of(linear)
    by_run = folds.of_instants.reshape(50, LENGTH)
    assert np.all(by_run == by_run[:, :1])
    assert not np.any(folds.gap)


@pytest.mark.parametrize("runs", [1, 3])
def test_a_run_that_stands_alone_is_cut_into_blocks(runs: int, rng: np.random.Generator) -> None:
    length = 80
    linear = design_with(rng.standard_normal(runs * length), rng.standard_normal((runs * length, 1)), runs)
    changed = np.zeros(runs * length)
    changed[:length] = 1.0
    folds = folds_of(linear, changed)
    assert folds.by == "block"
    assert len(folds) == BLOCKS + runs - 1
    mine = folds.of_instants[:length]
    np.testing.assert_array_equal(np.unique(mine), np.arange(BLOCKS))
    assert np.all(np.diff(mine) >= 0)
    for block in range(BLOCKS):
        inside, near = np.flatnonzero(mine == block), np.flatnonzero(folds.gap[:, block])
        assert len(near) > 0
        assert not set(inside) & set(near)
        assert np.all(np.minimum(abs(near - inside[0]), abs(near - inside[-1])) <= 3)


def test_what_is_held_out_does_not_depend_on_where_a_fit_stopped(rng: np.random.Generator) -> None:
    """What pulled on a parameter there was worth 19000 nats once, with the recording that tells it left out."""
    runs = 5
    column = rng.standard_normal(runs * LENGTH)
    linear = design_with(noise(rng, runs) + 0.5 * column, sensitivities(rng, runs), runs)
    fit, aside, more = fit_of(linear, column), np.array([2.0, -1.0, 0.5]), 0.1
    residual = fit.residual - (linear.sensitivities @ aside) - fit.jacobian @ [more]
    stopped = replace(fit, nuisances=fit.nuisances + aside, values=fit.values + more, residual=residual)
    folds = folds_of(linear)
    one, two = (tangent_of(linear, each) for each in (fit, stopped))
    expected = log_probability_of_folds(linear, one, folds)
    np.testing.assert_allclose(log_probability_of_folds(linear, two, folds), expected, rtol=1e-9)
    np.testing.assert_allclose(
        errors_of_folds(linear, stopped, two, folds), errors_of_folds(linear, fit, one, folds), atol=1e-9
    )
    assert log_probability_of_figures(stopped, two) == pytest.approx(log_probability_of_figures(fit, one))


def test_a_parameter_at_its_bound_stays_there_where_the_others_do_not_tell_it(rng: np.random.Generator) -> None:
    """What pulls beyond the bound is in the run that is left out, not in the prior."""
    runs = 5
    column = rng.standard_normal(runs * LENGTH) * (np.arange(runs * LENGTH) < LENGTH)
    linear = design_with(noise(rng, runs) - 10 * column, sensitivities(rng, runs), runs)
    without = fit_of(linear)
    free = fit_of(linear, column)
    low, _ = UNKNOWN.bounds
    assert free.values[0] < low  # else the test says nothing
    at_bound = replace(
        free, values=np.array([low]), nuisances=without.nuisances, residual=without.residual - low * column[:, None]
    )
    folds = folds_of(linear)
    np.testing.assert_allclose(
        log_probability_of_folds(linear, tangent_of(linear, at_bound), folds),
        log_probability_of_folds(linear, tangent_of(linear, without), folds),
        rtol=1e-9,
    )


def test_a_changed_copy_of_a_tangent_begins_with_nothing_left_out(rng: np.random.Generator) -> None:
    linear = design_with(noise(rng, 4), sensitivities(rng, 4), 4)
    tangent, folds = tangent_of(linear, fit_of(linear)), folds_of(linear)
    before = tangent.left_out(linear, folds)
    changed = replace(tangent, white=2 * tangent.white)
    assert np.all(changed.left_out(linear, folds).log_probability < before.log_probability)
    assert tangent.left_out(linear, folds) is before
