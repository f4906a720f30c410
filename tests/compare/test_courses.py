"""Products on any course are those of whitened columns, and a course more is no pass more over the readings."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bench.compare.background import Background, assembled, background_of
from bench.compare.courses import courses_of
from bench.compare.joint import joint_of
from bench.compare.profiles import Profile, profiles_of
from bench.compare.recordings import days_of, recordings_of
from bench.compare.search_changes import find_changes
from bench.compare.shared import SharedWhitening
from bench.diagnose.linearise.marginal import Gram, Nuisances
from bench.effects.catalogue import catalogue
from bench.record.campaign import Array
from bench.scenario.files import Experiment
from tests.diagnose.sweeps import LOADS, SWEEP, made, nominal

FEW = {name: catalogue()[name] for name in ("gas_loss", "coulomb_level", "torque_constant")}
AFTER = 3
RATE = 0.01
MISSED = 4.0  # variance of what the model misses each time, in those of the noise


@cache
def background(kind: str) -> Background:
    """Return four recordings: the same motion each time, or another one in the last but one."""
    session: Experiment = LOADS if kind == "loads" else SWEEP
    sessions = [session, SWEEP if kind == "another motion" else session, session]
    if kind == "another motion":
        sessions[1] = SWEEP.model_copy(update={"speeds_deg_per_s": (30.0,)})
    after = {f"day{k}": made(one, 2 + k, machine=3) for k, one in enumerate(sessions)}
    recordings = recordings_of({"before": made(session, 1, machine=3)}, after)
    own = background_of(joint_of(recordings, nominal(), FEW, most_bins=40))
    missed = replace(own.repeatability, shared=np.full_like(own.repeatability.shared, MISSED))
    return assembled(own.by_instant, missed, own.cells)


def profiles(kind: str) -> tuple[Profile, ...]:
    return profiles_of(1, days_of(background(kind).joint.recordings))


@pytest.mark.parametrize("kind", ["sweep", "loads", "another motion"])
def test_products_are_those_of_whitened_columns(kind: str) -> None:
    own = background(kind)
    assert kind != "loads" or any(len(back) for _, _, back in own.whitening.tied), "what segments have in common counts"
    assert np.max(own.whitening.back) > 0.5, "what repeats counts"
    first, second, *_, last = profiles(kind)
    even, odd = np.arange(0, own.columns.shape[1], 2), np.arange(1, own.columns.shape[1], 2)
    for groups in ([(even, first.weights)], [(odd, second.weights), (even, last.weights)]):
        columns = np.concatenate([own.acting(*group) for group in groups], axis=1)
        expected, found = own.nuisances.products(own.white, columns), courses_of(own).marginal(groups)
        size = np.sqrt(np.diag(expected.columns.gram)) + 1e-12
        np.testing.assert_allclose(found.information / size, expected.information / size, atol=1e-7)
        np.testing.assert_allclose(found.scores / size, expected.scores / size, atol=1e-7)
        np.testing.assert_allclose(found.diagonal / size**2, expected.diagonal / size**2, atol=1e-9)
        assert found.misfit == pytest.approx(expected.misfit)


def test_a_course_more_is_no_pass_more_over_the_readings(monkeypatch: pytest.MonkeyPatch) -> None:
    """Four campaigns, with six courses, were not compared after eight minutes of processor time."""
    own = background("sweep")
    passes = 0
    whiten, products = SharedWhitening.of_instants, Nuisances.products

    def whitened(self: SharedWhitening, values: Array) -> Array:
        nonlocal passes
        passes += 1
        return whiten(self, values)

    def multiplied(self: Nuisances, white: Array, columns: Array) -> object:
        nonlocal passes
        passes += 1
        return products(self, white, columns)

    monkeypatch.setattr(SharedWhitening, "of_instants", whitened)
    monkeypatch.setattr(Nuisances, "products", multiplied)
    counts = []
    for courses in (profiles("sweep")[:1], profiles("sweep")):
        passes = 0
        find_changes(own, courses, RATE)
        counts.append(passes)
    assert len(profiles("sweep")) == 2 * AFTER
    assert counts[0] == counts[1]


def test_of_columns_that_are_multiplied_the_same_follows(rng: np.random.Generator) -> None:
    none = Nuisances(rng.standard_normal((30, 3)))
    marginal = none.products(rng.standard_normal(30), rng.standard_normal((30, 6)))
    other = marginal.multiplied
    assert isinstance(other.columns, Gram)
    known, prior = np.array([1, 4]), np.array([0.5, 2.0])
    which, width = np.array([0, 3]), np.array([1.0, 3.0])
    assert other.log_evidence(which, width) == pytest.approx(marginal.log_evidence(which, width))
    one, two = marginal.given(known, prior), other.given(known, prior)
    np.testing.assert_allclose(one.information, two.information, atol=1e-10)
    np.testing.assert_allclose(one.scores, two.scores, atol=1e-10)
