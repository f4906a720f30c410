"""Held-out runs: the algebra against dense normal densities, and what pays and what does not."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from bench.diagnose.cross_validation.floor import floor_variance
from bench.diagnose.cross_validation.folds import folds_of
from bench.diagnose.cross_validation.held_out import held_out
from bench.diagnose.cross_validation.leave_out import (
    errors_of_folds,
    log_probability_of_figures,
    log_probability_of_folds,
    tangent_of,
)
from bench.diagnose.extend.fit import Fit, Unknown
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.noise_covariance import Scatter, Whitening
from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Conditions
from bench.record.held_out import BLOCKS
from bench.simulate.prescribed import Motion

SIGMA = 0.2  # [A]
LENGTH = 12  # instants of a run
EFFECT = catalogue()["gas_loss"]
CAUSE = Cause(EFFECT, WHOLE, EFFECT.parameters, ())
UNKNOWN = Unknown(CAUSE, EFFECT.parameters[0])


def design_with(
    residual: np.ndarray, sensitivities: np.ndarray, runs: int, modes: np.ndarray | None = None
) -> LinearisedModel:
    """Return a campaign of one channel, noise SIGMA; residual of shape (T,), changes of shape (T, p)."""
    n = len(residual) // runs
    zeros = np.zeros((n, 1))
    motion = Motion(np.arange(n, dtype=float), zeros, zeros, zeros, np.zeros((n, 6)), np.ones(n, dtype=bool))
    segments, whitenings = [], []
    for i in range(runs):
        observed, sigma = residual[i * n : (i + 1) * n, None], np.full((n, 1), SIGMA)
        standing = np.zeros(1, dtype=bool)
        at = Conditions.reference(1)
        segments.append(
            Segment(
                f"run{i}", f"run{i}", False, motion, at, observed, sigma, standing, 0 * sigma, observed[:, 0] < -np.inf
            )
        )
        factors = np.full((n, 1, 1), 1 / SIGMA)
        common = np.zeros((n, 0)) if modes is None else modes / SIGMA
        found, size, _ = np.linalg.svd(common, full_matrices=False)
        whitenings.append(Whitening(np.ones(n, dtype=bool), factors, found, 1 - 1 / np.sqrt(1 + size**2)))
    replay = SimpleNamespace(segments=tuple(segments), quantities=(Quantity("current_1_a", "current", "A"),))
    empty = np.empty(0)
    draft = LinearisedModel(
        replay=replay,  # type: ignore[arg-type]
        nuisances=tuple(Nuisance(f"n{i}", "", 1.0) for i in range(sensitivities.shape[1])),
        responses=(),
        whitenings=tuple(whitenings),
        scatter=Scatter(np.zeros(1), np.zeros((2, 1)), 0.0),
        weighed=tuple(segments),
        inflation=np.ones((2, 1)),
        unexplained=np.ones((2, 1)),
        sensitivities=sensitivities[:, None, :],
        residual=residual[:, None],
        jacobian=empty,
        white=empty,
        run_of=np.repeat(np.arange(runs), n),
        runs=tuple(f"run{i}" for i in range(runs)),
        column_of=np.zeros(len(residual), dtype=int),
    )
    return replace(draft, jacobian=draft.whiten(draft.sensitivities), white=draft.whiten(draft.residual))


def fit_of(linear: LinearisedModel, column: np.ndarray | None = None) -> Fit:
    """Return the exact fit of nuisances and, if there is a column of shape (T,), of one unknown."""
    jacobian = np.zeros((*linear.residual.shape, 0)) if column is None else column[:, None, None]
    unknowns = () if column is None else (UNKNOWN,)
    tangent = np.concatenate([linear.jacobian, linear.whiten(jacobian)], axis=1)
    p = linear.jacobian.shape[1]
    prior = np.concatenate([np.ones(p), [1 / u.sigma**2 for u in unknowns]])
    curvature = tangent.T @ tangent + np.diag(prior)
    found = np.linalg.solve(curvature, tangent.T @ linear.white)
    left = linear.residual - linear.sensitivities @ found[:p] - jacobian @ found[p:]
    causes = (CAUSE,) if unknowns else ()
    covariance = np.linalg.inv(curvature)[p:, p:]
    return Fit(causes, unknowns, found[p:], covariance, found[:p], 0.0, 0.0, left, jacobian, np.zeros(1))


def noise(rng: np.random.Generator, runs: int) -> np.ndarray:
    return SIGMA * rng.standard_normal(runs * LENGTH)


def sensitivities(rng: np.random.Generator, runs: int, p: int = 3) -> np.ndarray:
    return 0.3 * rng.standard_normal((runs * LENGTH, p))


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


def in_recordings(linear: LinearisedModel, whose: tuple[str | None, ...]) -> LinearisedModel:
    """Return a campaign of which each run is a recording, with nuisances that belong to all or to one."""
    segments = tuple(replace(segment, recording=segment.run) for segment in linear.segments)
    replay = SimpleNamespace(segments=segments, quantities=linear.quantities)
    nuisances = tuple(Nuisance(f"n{i}", "", 1.0, recording=name) for i, name in enumerate(whose))
    return replace(linear, replay=replay, nuisances=nuisances)  # type: ignore[arg-type]


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


def test_a_recording_that_denies_a_finding_is_named(rng: np.random.Generator) -> None:
    column = rng.standard_normal(2 * LENGTH)
    for share, confirmed in ((1.0, ["run0", "run1"]), (-1.0, [])):
        residual = noise(rng, 2) + 0.3 * column * np.repeat([1.0, share], LENGTH)
        linear = in_recordings(design_with(residual, np.zeros((2 * LENGTH, 1)), 2), (None,))
        gain = held_out(linear, fit_of(linear), fit_of(linear, column))
        assert gain.by == "recording"
        assert [one.recording for one in gain.recordings if one.confirms] == confirmed
        assert gain.is_gain == bool(confirmed)


def test_figures_stay_within_reach(rng: np.random.Generator) -> None:
    jacobian = sensitivities(rng, 4, p=1)
    linear = design_with(noise(rng, 4) + 10 * jacobian[:, 0], jacobian, 4)
    fit = fit_of(linear)
    assert abs(fit.nuisances[0]) > 8  # else the test says nothing
    found = errors_of_folds(linear, fit, tangent_of(linear, fit), folds_of(linear), reach=4.0)
    np.testing.assert_allclose(found[:, 0], linear.residual[:, 0] - 4 * jacobian[:, 0], atol=1e-9)


def test_a_true_extension_pays_and_an_invented_one_does_not() -> None:
    runs, refused = 10, 0
    for seed in range(20):
        rng = np.random.default_rng(seed)
        jacobian, column = sensitivities(rng, runs), rng.standard_normal(runs * LENGTH)
        true = design_with(noise(rng, runs) + 0.15 * column, jacobian, runs)
        assert held_out(true, fit_of(true), fit_of(true, column)).is_gain
        null = design_with(noise(rng, runs), jacobian, runs)
        refused += not held_out(null, fit_of(null), fit_of(null, column)).is_gain
    assert refused >= 17  # an interval of 90 % lets one in twenty pass on each side


def test_what_one_run_shows_and_the_others_deny_is_refused(rng: np.random.Generator) -> None:
    runs = 10
    column = rng.standard_normal(runs * LENGTH)
    residual = noise(rng, runs)
    residual[:LENGTH] += 1.5 * column[:LENGTH]  # a glitch
    linear = design_with(residual, sensitivities(rng, runs), runs)
    before, after = fit_of(linear), fit_of(linear, column)
    fell = np.sum(linear.whiten(before.residual) ** 2) - np.sum(linear.whiten(after.residual) ** 2)
    assert fell > 20  # the fit alone would take it: log evidence above 4.6 after the price of one parameter
    found = held_out(linear, before, after)
    assert found.by == "run"
    assert not found.is_gain


def test_two_runs_of_twenty_are_enough(rng: np.random.Generator) -> None:
    runs = 20
    column = np.zeros(runs * LENGTH)
    column[: 2 * LENGTH] = rng.standard_normal(2 * LENGTH)
    linear = design_with(noise(rng, runs) + 0.5 * column, sensitivities(rng, runs), runs)
    found = held_out(linear, fit_of(linear), fit_of(linear, column))
    assert found.by == "run"
    assert found.is_gain


def test_an_absurd_figure_does_not_stand_in_for_a_cause(rng: np.random.Generator) -> None:
    runs = 10
    jacobian = sensitivities(rng, runs)
    column = jacobian[:, 0] * 10 / UNKNOWN.sigma  # it acts exactly as the first nuisance
    linear = design_with(noise(rng, runs) + 10 * jacobian[:, 0], jacobian, runs)
    found = held_out(linear, fit_of(linear), fit_of(linear, column))
    assert abs(found.nats - found.figures) < 2  # runs alone cannot tell
    assert found.is_gain
    assert found.channels[0].gain > 0.4
    within = design_with(noise(rng, runs) + 0.5 * jacobian[:, 0], jacobian, runs)
    assert not held_out(within, fit_of(within), fit_of(within, column)).is_gain


def test_what_changes_nothing_does_not_pay(rng: np.random.Generator) -> None:
    linear = design_with(noise(rng, 4), sensitivities(rng, 4), 4)
    found = held_out(linear, fit_of(linear), fit_of(linear, np.zeros(4 * LENGTH)))
    assert found.nats == pytest.approx(0.0, abs=1e-9)
    assert not found.is_gain


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


def test_a_perfect_model_is_as_good_as_its_floor() -> None:
    runs = 40
    rng = np.random.default_rng(3)
    modes = np.linspace(0.1, 0.5, LENGTH)[:, None]
    shared = np.concatenate([modes[:, 0] * rng.standard_normal() for _ in range(runs)])
    linear = design_with(noise(rng, runs) + shared, 1e-9 * sensitivities(rng, runs), runs, modes)
    expected = np.tile(SIGMA**2 + modes[:, 0] ** 2, runs)
    np.testing.assert_allclose(floor_variance(linear)[:, 0], expected)
    channel = held_out(linear, fit_of(linear), fit_of(linear)).channels[0]
    assert channel.after / channel.floor == pytest.approx(1.0, abs=0.12)  # 40 draws of a mode: 3 % to 5 % each way
    assert channel.gain == pytest.approx(0.0, abs=1e-9)


def test_the_nominal_model_as_it_stands_and_what_was_measured_stand_beside_the_gain(rng: np.random.Generator) -> None:
    runs = 6
    column = rng.standard_normal(runs * LENGTH)
    linear = design_with(noise(rng, runs) + 2 * column + 0.7, sensitivities(rng, runs), runs)
    (found,) = held_out(linear, fit_of(linear), fit_of(linear, column)).channels
    # all readings weigh alike here, and the replay of this made-up campaign predicts nothing at all
    assert found.nominal == pytest.approx(np.sqrt(np.mean(linear.residual**2)))
    assert found.measured == pytest.approx(np.std(linear.residual))
    assert found.measured < found.nominal


def test_a_nominal_model_that_the_other_runs_bend_is_no_straw_man(rng: np.random.Generator) -> None:
    jacobian = sensitivities(rng, 2, p=1)
    away = np.repeat([3.0, -3.0], LENGTH)  # two runs that want the opposite of the same figure
    linear = design_with(noise(rng, 2) + away * jacobian[:, 0], jacobian, 2)
    before, after = fit_of(linear), fit_of(linear, away * jacobian[:, 0])
    (found,) = held_out(linear, before, after).channels
    assert found.before > 1.5 * found.nominal
    assert found.over_better == pytest.approx(1 - found.after / found.nominal)
    assert found.over_better_low < found.over_better < found.over_better_high


def test_raised_errors_do_not_raise_the_floor(rng: np.random.Generator) -> None:
    linear = design_with(noise(rng, 3), sensitivities(rng, 3), 3)
    heavier = replace(
        linear,
        weighed=tuple(replace(s, sigma=2 * s.sigma) for s in linear.weighed),
        whitenings=tuple(replace(w, factors=w.factors / 2) for w in linear.whitenings),
        inflation=np.full((2, 1), 2.0),
    )
    np.testing.assert_allclose(floor_variance(heavier), floor_variance(linear))
