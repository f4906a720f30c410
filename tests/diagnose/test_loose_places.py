"""How far apart loose links lie from run to run is read from the runs, and a play scatters them by no more."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.loose_places import most_placed
from bench.diagnose.linearise.noise_covariance import measured_in, of_links
from bench.diagnose.linearise.other_noise import with_places, with_play, with_scatter
from bench.diagnose.linearise.rattling import PLACED
from bench.record.campaign import Array
from tests.diagnose.small_models import linear_of
from tests.diagnose.sweeps import SWEEPS, made

JOINT = 0  # it stands while joint 2 moves, and nothing pushes it
GAP = 3e-4  # [rad]
APART = 5e-4  # [rad], of places


@pytest.fixture(scope="module")
def linear() -> LinearisedModel:
    return linear_of(made(SWEEPS, seed=5))


def place_of(linear: LinearisedModel, i: int) -> Array:
    """Return what a place of the link changes in a run, shape (T, c), per rad."""
    segment = linear.segments[i]
    assert segment.standing[JOINT]
    assert not segment.is_static
    measured = measured_in(segment, linear.quantities)
    return of_links(linear.replay.compiled, linear.responses[i], measured, linear.quantities)[:, :, JOINT]


def allowed(linear: LinearisedModel, rng: np.random.Generator, deviation: float, runs: int, jacobian: Array) -> float:
    """Return the largest deviation that is read from runs whose places differ by one, all else being by chance."""
    compiled, white = linear.replay.compiled, [jacobian @ rng.standard_normal(jacobian.shape[1])]
    for i in range(runs):
        place = linear.whitenings[i](place_of(linear, i)) * deviation * rng.standard_normal()
        white.append(place + rng.standard_normal(len(place)))
    known = (linear.segments[:runs], linear.responses[:runs], linear.quantities, linear.whitenings[:runs])
    return float(most_placed(compiled, *known, jacobian, white[0] + np.concatenate(white[1:]))[JOINT])


def first_rows(linear: LinearisedModel, runs: int) -> Array:
    return linear.jacobian[: sum(len(whitening.modes) for whitening in linear.whitenings[:runs])]


def test_as_much_as_places_differ_is_allowed_and_little_where_they_do_not(linear: LinearisedModel) -> None:
    """It is the 95th percentile: of 60 draws, 52 to 60 allow what there is in all but 1 % of cases."""
    rng, runs = np.random.default_rng(1), len(linear.segments)
    assert runs >= 4
    jacobian = first_rows(linear, runs)
    found = {apart: [allowed(linear, rng, apart, runs, jacobian) for _ in range(60)] for apart in (0.0, APART)}
    print({apart: np.quantile(one, [0.05, 0.5, 0.95]) for apart, one in found.items()})
    assert np.count_nonzero(np.array(found[APART]) >= APART) >= 52
    assert np.median(found[APART]) < 6 * APART
    assert np.median(found[0.0]) < APART / 4


def test_what_a_figure_may_explain_tells_nothing(linear: LinearisedModel) -> None:
    """The tracker may be turned by as much as the link of the only run lies aside."""
    turned = linear.whitenings[0](place_of(linear, 0))[:, None] * 1e-3
    rng = np.random.default_rng(2)
    freely, turns = (allowed(linear, rng, 0.0, 1, one) for one in (0 * turned, turned))
    assert freely < GAP
    assert turns > 1e-3


def test_where_nothing_tells_a_link_may_lie_anywhere(linear: LinearisedModel) -> None:
    nothing = np.zeros((0, 1))
    found = most_placed(linear.replay.compiled, (), (), linear.quantities, (), nothing, np.zeros(0))
    assert np.all(np.isinf(found))
    assert np.isinf(most_placed(*_known(linear))[1])  # joint 2 moves
    assert linear.scatter.placed is not None
    np.testing.assert_array_equal(linear.scatter.placed, most_placed(*_known(linear)))


def _known(linear: LinearisedModel) -> tuple:
    known = (linear.replay.compiled, linear.weighed, linear.responses, linear.quantities, linear.whitenings)
    return (*known, linear.jacobian, linear.white)


@pytest.mark.parametrize("most", [2e-5, 1.0], ids=["less", "more"])
def test_a_play_scatters_links_by_no_more_than_runs_allow(linear: LinearisedModel, most: float) -> None:
    n = linear.replay.compiled.n_joints
    play = GAP * (np.arange(n) == JOINT)
    covariances = []
    for placed in (np.zeros(n), np.full(n, most)):
        about = with_scatter(linear, replace(linear.scatter, play=play, placed=placed))
        m = len(about.whitenings[0].modes)
        inverse = about.unwhiten(np.eye(len(about.white))[:, :m])[: len(linear.segments[0])].reshape(-1, m)
        covariances.append(inverse @ inverse.T)
    expected = min(most, PLACED * GAP) * place_of(linear, 0).ravel()
    rows = linear.whitenings[0].rows
    found = (covariances[1] - covariances[0])[np.ix_(rows, rows)]
    np.testing.assert_allclose(found, np.outer(expected, expected)[np.ix_(rows, rows)], atol=1e-4 * np.max(expected**2))


def test_what_a_better_model_leaves_says_how_far_apart_links_lie(linear: LinearisedModel) -> None:
    """A misfit that a finding takes away had let links lie where they do not, so a play was charged for it (1081)."""
    rng = np.random.default_rng(3)
    aside = [APART * rng.standard_normal() * place_of(linear, i) for i in range(len(linear.segments))]
    unplaced = replace(linear, scatter=replace(linear.scatter, placed=None))
    before = with_places(unplaced, linear.residual + np.concatenate(aside))
    after = with_places(before, linear.residual)
    again = with_places(after, linear.residual + np.concatenate(aside))
    assert before.scatter.placed is not None
    assert after.scatter.placed is not None
    assert after.scatter.placed[JOINT] < before.scatter.placed[JOINT] / 2
    np.testing.assert_array_equal(again.scatter.placed, after.scatter.placed)


def test_a_play_that_a_model_has_changes_nothing_of_what_is_read(linear: LinearisedModel) -> None:
    play = GAP * (np.arange(linear.replay.compiled.n_joints) == JOINT)
    unplaced = replace(linear, scatter=replace(linear.scatter, placed=None))
    with_it = with_places(with_play(unplaced, play), linear.residual).scatter
    np.testing.assert_allclose(with_it.placed, with_places(unplaced, linear.residual).scatter.placed)
    np.testing.assert_array_equal(with_it.play, play)
