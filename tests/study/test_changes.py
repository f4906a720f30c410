"""Pairs of recordings of one messy machine, and what a comparison says of them."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.study.changes import Outcome, counts_of, outcome_of, pair_of
from bench.study.labs import Lab, Setup, prepare

RIGHT = Outcome("gas_loss: lost 0.01", 0.25, 3.0, 8.0, True, "loss of gas", True, True, True, True)
MISSED = replace(RIGHT, said="", is_named=False, is_first=False, is_among_first=False, is_in_set=False)
QUIET = Outcome("", 0.0, 0.0, 0.0, False, "", False, False, False, False)
UNSEEN_SEED = 8001
PAIRS = 12
FALSE_ALARMS = 2  # of 12, at a rate of 1 %, with a probability of 0.0002 more


def test_counts() -> None:
    assert counts_of([RIGHT, MISSED]).startswith(
        "2 pairs with a change: named in 1, the right cause first and alone in 1"
    )
    assert counts_of([QUIET, replace(QUIET, is_named=True)]) == "2 pairs without a change: a change is named in 1"


@cache
def setup() -> Setup:
    return prepare(Lab(), catalogue(), np.random.default_rng(UNSEEN_SEED))


def outcomes_of(with_change: bool) -> list[Outcome]:
    every = (pair_of(setup(), i, UNSEEN_SEED, with_change=with_change) for i in range(PAIRS))
    return [outcome_of(pair, setup()) for pair in every]


@pytest.mark.study
def test_messy_machines_that_stay_as_they_are_have_not_changed() -> None:
    outcomes = outcomes_of(with_change=False)
    assert sum(one.is_named for one in outcomes) <= FALSE_ALARMS, counts_of(outcomes)


@pytest.mark.study
def test_most_changes_that_stand_out_of_the_limits_of_a_comparison_are_found() -> None:
    outcomes = outcomes_of(with_change=True)
    clear = [one for one in outcomes if one.times > 1.5]
    assert sum(one.is_in_set for one in clear) > len(clear) / 2, counts_of(clear)
