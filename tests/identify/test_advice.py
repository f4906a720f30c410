"""Advice is checked by taking it: the visit that is named must make the joint known as well as was said."""

from dataclasses import replace

import numpy as np
import pytest

from bench.errors import InputError
from bench.identify.advice import WEAK, advise, sentence
from bench.identify.arm import Arm
from bench.identify.force import identify_force
from bench.identify.methods import METHODS
from bench.identify.options import Options
from tests.identify.hh150 import COUNTERBALANCE, POINTS, STIFFNESS, hh150
from tests.identify.static_world import Ladder, World, measure
from tests.identify.test_methods import ladders

FREE = World(np.zeros(6), np.zeros(6))
PROMISE = 1.5  # by how much the error may exceed what was predicted from a guessed stiffness


@pytest.fixture(scope="module")
def arm():
    return Arm(hh150())


def test_a_joint_that_cannot_be_seen_is_seen_after_the_advice(arm, rng):
    visits = ladders()[:8]
    readings = measure(FREE, visits, rng)
    before = identify_force(arm, COUNTERBALANCE, readings, Options())
    (advice,) = advise(arm, COUNTERBALANCE, readings, before)
    assert advice.joint == 0
    assert not advice.hangs
    words = sentence(advice, before)
    assert words.startswith("To see joint_1, add a pose near (")
    assert "pulling horizontally along" in words
    low, high = arm.bodies.limits.T
    assert np.all((low < advice.q) & (advice.q < high))

    force = advice.load.forces[0]
    added = Ladder(advice.q, np.array(advice.load.direction), (0.0, force), 1)
    after = identify_force(arm, COUNTERBALANCE, measure(FREE, [*visits, added], rng), Options())
    assert after.observable[0]
    # the prediction was made for a joint as stiff as the median of the others; a stiffer one moves less
    softer = STIFFNESS[0] / np.median(STIFFNESS[1:])
    reached = np.sqrt(after.covariance[0, 0]) / after.compliance[0]
    assert reached < PROMISE * max(softer, 1.0) * advice.relative_error


@pytest.mark.parametrize("direction_sigma", [0.005, 0.0])
def test_a_weak_joint_gets_a_better_pose(arm, rng, direction_sigma):
    """Weights alone, without a force sensor, have a direction that is known: advice was "would make that nan%"."""
    readings = measure(FREE, ladders(), rng)
    readings = replace(readings, systematic=replace(readings.systematic, force_direction=direction_sigma))
    coarse = replace(readings, sigma_reflector=100 * readings.sigma_reflector)
    estimate = identify_force(arm, COUNTERBALANCE, coarse, Options())
    error = np.sqrt(np.diag(estimate.covariance)) / estimate.compliance
    found = advise(arm, COUNTERBALANCE, coarse, estimate)
    assert [advice.joint for advice in found] == list(np.flatnonzero(~(error <= WEAK)))
    for advice in found:
        if estimate.observable[advice.joint]:
            assert advice.relative_error < error[advice.joint]


def test_no_advice_where_none_is_needed(arm, rng):
    readings = measure(FREE, ladders(), rng)
    estimate = identify_force(arm, COUNTERBALANCE, readings, Options())
    assert advise(arm, COUNTERBALANCE, readings, estimate) == ()
    assert METHODS["force"](arm, COUNTERBALANCE, readings, Options()).notes == estimate.notes


@pytest.mark.parametrize("method", ["current", "force", "joint"])
def test_a_load_point_on_the_last_axis_is_said_and_no_pose_is_named_for_it(monkeypatch, rng, method):
    """A hook on axis 6: "add a pose near ... with 1500 N hanging"; no load through that point turns it."""
    monkeypatch.setitem(POINTS, "load", [0.0, 0.0, POINTS["load"][2]])
    on_axis = Arm(hh150())
    readings = measure(FREE, ladders(), rng)
    estimate = METHODS[method](on_axis, COUNTERBALANCE, readings, Options())
    assert list(estimate.observable) == [True] * 5 + [False]
    said = [note for note in estimate.notes if "load point lies on the axis of joint_6" in note]
    assert len(said) == 1
    assert not any("To see joint_6" in note or "joint_6 is known to" in note for note in estimate.notes)


def test_the_same_readings_give_the_same_advice(arm, rng):
    readings = measure(FREE, ladders()[:8], rng)
    notes = [METHODS["force"](arm, COUNTERBALANCE, readings, Options()).notes for _ in range(2)]
    assert notes[0] == notes[1]


def test_without_any_stiffness_there_is_no_advice(arm, rng):
    readings = measure(FREE, ladders()[:2], rng)
    blank = identify_force(arm, COUNTERBALANCE, readings, Options())
    blank = replace(blank, observable=np.zeros(6, dtype=bool))
    with pytest.raises(InputError, match="no joint is observable"):
        advise(arm, COUNTERBALANCE, readings, blank)
