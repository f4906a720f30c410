"""Numbers of a study: shares with intervals that cover, goals met and missed, probabilities that hold or do not."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom

from bench.report.study.words import measured_words
from bench.study.goals import Goal
from bench.study.outcome import Answer, Outcome
from bench.study.scores import scores_of
from bench.study.shares import Mean, Share
from tests.study.answers import COULOMB, LOSS, WARM, explanation, outcome, single, truth

MANY = 400


def goal(outcomes: list[Outcome], name: str) -> Goal:
    (found,) = (one for one in scores_of(outcomes).goals if one.name.startswith(name))
    return found


@pytest.mark.parametrize(("hits", "of"), [(0, 200), (2, 200), (19, 20), (20, 20), (7, 11)])
def test_interval_is_that_of_clopper_and_pearson(hits: int, of: int) -> None:
    """At each end of it, what was counted or something more extreme has a probability of 2.5 %."""
    low, high = Share(hits, of).interval
    assert low == 0 if hits == 0 else binom.sf(hits - 1, of, low) == pytest.approx(0.025)
    assert high == 1 if hits == of else binom.cdf(hits, of, high) == pytest.approx(0.025)


def test_nothing_counted_says_nothing() -> None:
    assert np.isnan(Share(0, 0).value)
    assert Share(0, 0).interval == (0.0, 1.0)
    assert np.isnan(Mean.over([]).value)
    assert goal([], "false alarms").met is None


def test_interval_of_a_mean_covers(rng: np.random.Generator) -> None:
    hits = sum(low <= 1 <= high for low, high in (Mean.over(list(rng.normal(1, 2, 8))).interval for _ in range(MANY)))
    low, high = Share(hits, MANY).interval
    assert low <= 0.95 <= high


def test_false_alarms_are_counted() -> None:
    quiet = [outcome("null", (), Answer("nothing found")) for _ in range(99)]
    alarm = outcome("null", (), Answer("cause", (explanation(LOSS),)))
    assert goal([*quiet, alarm], "false alarms").met
    assert not goal([*quiet, alarm, alarm], "false alarms").met


def test_planted_wrong_names_miss_the_goals() -> None:
    right, wrong = single(explanation(LOSS)), single(explanation(COULOMB))
    assert goal([right] * 20, "right cause first").met
    assert goal([right] * 100 + [wrong], "right cause in the named set").met
    assert not goal([right] * 8 + [wrong] * 2, "right cause first").met
    assert not goal([right] * 98 + [wrong] * 2, "right cause in the named set").met


def test_only_effects_at_three_limits_have_to_be_found() -> None:
    small = single(true=truth(LOSS, times_limit=1.0))
    assert goal([small], "effect found").measured == Share(0, 0)
    assert goal([single()], "effect found").measured == Share(0, 1)


def verdicts(rng: np.random.Generator, right: float, said: float) -> list[Outcome]:
    """Return verdicts that give `said` to their first cause, of which a share `right` is."""
    one, other = explanation(LOSS, probability=said), explanation(WARM, probability=said)
    return [single(one if rng.random() < right else other) for _ in range(MANY)]


def test_calibrated_probabilities_pass(rng: np.random.Generator) -> None:
    outcomes = [o for p in (0.6, 0.8, 0.95) for o in verdicts(rng, p, p)]
    scores = scores_of(outcomes)
    assert [one.right.of for one in scores.bins] == [MANY] * 3
    assert all(one.is_calibrated for one in scores.bins)
    assert goal(outcomes, "bins").met


@pytest.mark.parametrize(("right", "said"), [(0.75, 0.95), (0.95, 0.8)])
def test_miscalibrated_probabilities_are_noticed(rng: np.random.Generator, right: float, said: float) -> None:
    outcomes = verdicts(rng, right, said)
    (only,) = scores_of(outcomes).bins
    assert not only.is_calibrated
    assert not goal(outcomes, "bins").met


@pytest.mark.parametrize(("error", "is_met"), [(1.0, True), (0.5, False), (2.0, False)])
def test_coverage_is_held_between_85_and_95_percent(rng: np.random.Generator, error: float, is_met: bool) -> None:
    """`error` is the true scatter of the estimates over the standard deviation that they state."""
    outcomes = [single(explanation(LOSS, value=0.1 + 0.01 * error * rng.standard_normal())) for _ in range(MANY)]
    assert goal(outcomes, "90 % intervals").met is is_met


def test_time_has_no_interval_that_begins_below_zero() -> None:
    times = (6.0, 8.0, 9.0, 196.0)  # the interval of their mean by Student's t begins at -95 s
    study = scores_of(replace(outcome("null", (), Answer("nothing found")), diagnose_s=time) for time in times)
    (goal,) = (goal for goal in study.goals if "seconds" in goal.name)
    assert goal.name == "seconds for the longest diagnosis, on one core"
    assert goal.goal == "<= 120, as 60 on 2 cores"
    assert measured_words(goal.measured) == "mean 54.75 over 4, largest 196.00"
    assert goal.met is False


def test_misses_are_listed_with_words() -> None:
    scores = scores_of([single(explanation(LOSS)), single(explanation(COULOMB)), single()])
    assert len(scores.misses) == 2
    assert "coulomb_level (joint 2)" in scores.misses[0][1]
    assert "nothing found" in scores.misses[1][1]


def test_effects_are_told_what_they_were_taken_for() -> None:
    (only,) = scores_of([single(explanation(LOSS)), single(explanation(COULOMB)), single(explanation(COULOMB))]).effects
    assert only.effect == "gas_loss"
    assert only.first == Share(1, 3)
    assert only.taken_for == (("coulomb_level", 2),)
