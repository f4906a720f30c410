"""What visits of the same pose have in common: a second recording does not tell it better than one."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.cross_validation.floor import floor_variance
from bench.diagnose.extend.fit import pseudo_residual
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.generic import blocks_of
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.marginal import Nuisances
from bench.diagnose.linearise.noise_covariance import LINK_REST, LINK_VISIT, MOTOR_REST, MOTOR_VISIT
from bench.diagnose.linearise.other_noise import with_play, with_scatter
from bench.diagnose.linearise.rattling import PLACED
from bench.diagnose.linearise.repeated_rests import ANYTHING, SHARES, repeating_share, repeating_visits, whitenings_of
from bench.diagnose.linearise.threshold import LEAST
from bench.diagnose.replay.play import is_loose
from bench.record.campaign import Array
from bench.record.joined import joined
from tests.diagnose.noise_free import linearised, noise_free
from tests.diagnose.small_models import linear_of
from tests.diagnose.sweeps import LOADS, made

SHARE = 0.6


@pytest.fixture(scope="module")
def linear() -> LinearisedModel:
    """Two recordings of the same visits."""
    return linear_of(joined({name: made(LOADS, seed=5 + i, machine=5) for i, name in enumerate(("may", "june"))}))


def repeating(linear: LinearisedModel, share: float) -> LinearisedModel:
    return with_scatter(linear, replace(linear.scatter, repeats=share))


def friction_of(linear: LinearisedModel, i: int) -> Array:
    """Return what friction at rest changes in a visit, shape (T * c, k), each column with a deviation of one."""
    response = linear.responses[i]
    length, c, n = response.link.shape
    levels = linear.scatter.levels
    spread = np.concatenate([response.link * levels[0], response.motor * levels[1]], axis=2)
    columns = [spread * np.repeat([LINK_VISIT, MOTOR_VISIT], n)]
    for t in range(length):
        columns.append(spread * np.repeat([LINK_REST, MOTOR_REST], n) * (np.arange(length) == t)[:, None, None])
    return np.concatenate(columns, axis=2).reshape(length * c, -1)


def test_a_visit_repeats_one_of_the_same_pose_from_the_same_side(linear: LinearisedModel) -> None:
    sets = repeating_visits(linear.segments)
    assert sets
    assert sorted(i for visits in sets for i in visits) == list(range(len(linear.segments)))
    for one, other in sets:
        assert linear.segments[one].recording != linear.segments[other].recording
        assert linear.segments[one].label.removeprefix("may.") == linear.segments[other].label.removeprefix("june.")


def test_a_visit_of_very_many_rests_counts_as_new_each_time(
    linear: LinearisedModel, monkeypatch: pytest.MonkeyPatch
) -> None:
    longest = max(len(segment) for segment in linear.segments)
    monkeypatch.setattr("bench.diagnose.linearise.repeated_rests.MOST_RESTS", longest - 1)
    found = repeating_visits(linear.segments)
    assert not any(len(linear.segments[i]) == longest for visits in found for i in visits)


def places_of(linear: LinearisedModel, i: int) -> Array:
    """Return what the places of loose links change in a visit, shape (T * c, k), with a deviation of one each."""
    compiled, response = linear.replay.compiled, linear.responses[i]
    gaps = response.link * compiled.stiffness * linear.scatter.play
    gaps[:, [quantity.is_drive for quantity in linear.quantities]] = 0.0
    loose = is_loose(compiled, response.link_load)
    length, c, n = gaps.shape
    columns = np.zeros((length, c, length, n))
    for j in range(n):
        first = 0
        for t in range(length):
            first = first if t and loose[t - 1, j] else t
            columns[t, :, first, j] = PLACED * gaps[t, :, j] * loose[t, j]
    return columns.reshape(length * c, -1)


@pytest.mark.parametrize("gap", [0.0, 3e-4], ids=["friction", "and play"])
def test_the_covariance_is_shared_between_visits_and_the_same_within_each(linear: LinearisedModel, gap: float) -> None:
    """Places of loose links repeat too: a second visit that found them there again was charged for it as for luck."""
    linear = with_play(linear, gap * (np.arange(linear.replay.compiled.n_joints) == 0))
    about, alone = repeating(linear, SHARE), repeating(linear, 0.0)
    one, other = repeating_visits(linear.segments)[0]
    m = sum(len(whitening.modes) for whitening in about.whitenings)
    for i, k in ((one, one), (one, other)):
        maps = [model.unwhiten(np.eye(m)) for model in (about, alone)]
        edges = np.cumsum([0, *(len(segment) for segment in linear.segments)])
        first, second = ([at[edges[j] : edges[j + 1]].reshape(-1, m) for at in maps] for j in (i, k))
        found, independent = (a @ b.T for a, b in zip(first, second, strict=True))
        rows = np.ix_(about.whitenings[i].rows, about.whitenings[k].rows)
        mine, theirs = (np.concatenate([friction_of(linear, j), places_of(linear, j)], axis=1) for j in (i, k))
        expected = independent if i == k else SHARE * mine @ theirs.T
        assert np.any(places_of(linear, i)) == (gap > 0)
        scale = np.abs(independent[rows]).max() if i == k else np.abs(expected[rows]).max()
        np.testing.assert_allclose(found[rows], expected[rows], atol=1e-9 * scale)


def test_it_is_undone_and_knows_its_determinant(linear: LinearisedModel) -> None:
    about = repeating(linear, SHARE)
    shape = linear.replay.shape
    seen = np.concatenate([whitening.rows for whitening in about.whitenings])
    matrix = about.whiten(np.eye(len(seen))[:, seen].reshape(*shape, -1))
    assert about.log_determinants.sum() == pytest.approx(np.linalg.slogdet(matrix)[1])
    values = np.random.default_rng(0).standard_normal((*shape, 2))
    seen = seen.reshape(shape)
    np.testing.assert_allclose(about.unwhiten(about.whiten(values))[seen], values[seen], atol=1e-9)


def test_the_floor_of_a_reading_is_the_same_whatever_repeats(linear: LinearisedModel) -> None:
    np.testing.assert_allclose(floor_variance(repeating(linear, SHARE)), floor_variance(repeating(linear, 0.0)))


@pytest.mark.parametrize("share", [0.0, 0.5, 0.9])
def test_the_share_is_found_in_the_differences(linear: LinearisedModel, share: float) -> None:
    rng, known = np.random.default_rng(3), (linear.replay.compiled, linear.segments, linear.responses)
    scatter = replace(linear.scatter, repeats=0.0)
    found = []
    for _ in range(10):
        left = [segment.sigma * rng.standard_normal(segment.sigma.shape) for segment in linear.segments]
        for visits in repeating_visits(linear.segments):
            columns = friction_of(linear, visits[0])
            common = columns @ rng.standard_normal(columns.shape[1])
            for i in visits:
                columns = friction_of(linear, i)
                own = columns @ rng.standard_normal(columns.shape[1])
                left[i] += (np.sqrt(share) * common + np.sqrt(1 - share) * own).reshape(left[i].shape)
        found.append(repeating_share(*known, linear.quantities, scatter, left))
    assert np.mean(found) == pytest.approx(share, abs=0.1)


def test_what_repeats_nothing_has_no_share_and_what_hardly_repeats_may_have_any(linear: LinearisedModel) -> None:
    first, _ = repeating_visits(linear.segments)[0]
    few = replace(linear.segments[first], observed=linear.segments[first].observed * np.nan)
    for visits, expected in (((linear.segments[first],), 0.0), ((few, few), ANYTHING)):
        n = len(visits)
        known = (linear.replay.compiled, visits, [linear.responses[first]] * n, linear.quantities, linear.scatter)
        assert repeating_share(*known, [0 * few.sigma] * n) == expected


def test_rests_on_which_the_fast_algorithm_gives_up(linear: LinearisedModel, monkeypatch: pytest.MonkeyPatch) -> None:
    """A stranger's unchanged days ended in "SVD did not converge", on finite numbers."""
    residuals = [np.nan_to_num(segment.observed) * 1e-6 for segment in linear.segments]
    known = (linear.replay.compiled, linear.segments, linear.responses, linear.quantities, linear.scatter, residuals)
    expected = repeating_share(*known)

    def gives_up(*_: object, **__: object) -> None:
        raise np.linalg.LinAlgError("SVD did not converge")

    monkeypatch.setattr(np.linalg, "svd", gives_up)
    assert repeating_share(*known) == expected


def test_visits_of_which_nothing_was_read_have_nothing_in_common(linear: LinearisedModel) -> None:
    first, _ = repeating_visits(linear.segments)[0]
    unread = replace(linear.segments[first], observed=linear.segments[first].observed * np.nan)
    known = (linear.replay.compiled, (unread, unread), [linear.responses[first]] * 2, linear.quantities)
    _, repeated = whitenings_of(*known, replace(linear.scatter, repeats=SHARE))
    assert repeated == ()


@pytest.mark.study
def test_two_sound_recordings_show_no_error_of_a_reflector_under_force() -> None:
    """It was named in four of five pairs: each time, friction left links of the first pose in the same place."""
    days = joined({"may": noise_free("session-study", 904), "june": noise_free("session-study", 905)})
    linear = linearised(days)
    assert linear.scatter.repeats == SHARES[-1]  # one program, without noise
    with_it, without = evidence(linear), evidence(repeating(linear, 0.0))
    assert with_it < LEAST
    assert with_it < without - 1  # 10 before replays knew which way friction turns under a load


def evidence(linear: LinearisedModel) -> float:
    """Return the evidence for an error of the reflector that depends on force, of the best width, in nats."""
    block = next(block for block in blocks_of(linear) if block.place == "reflector 1")
    products = Nuisances(linear.jacobian).products(pseudo_residual(linear, refit(linear, (), {})), block.columns)
    count = block.columns.shape[1]
    found = [products.log_evidence(np.arange(count), np.full(count, share * block.prior)) for share in (0.3, 0.1, 0.03)]
    print(f"{max(found):.1f} nats with {linear.scatter.repeats:.2f} of the friction at rest repeating")
    return max(found)
