"""Readings at rest that do not go with their loads are told, and so are repeats that are copies."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.plausibility.channels import doubts_of
from bench.diagnose.plausibility.copied_repeats import copied_repeats
from bench.diagnose.plausibility.repeated import Repeated
from bench.record.campaign import Array, Campaign
from bench.robot.compiled import CompiledRobot
from tests.diagnose.sweeps import nominal
from tests.diagnose.test_one_more_number import session, without_force

Order = Callable[[Array], np.ndarray]


@pytest.fixture(scope="module")
def compiled() -> CompiledRobot:
    return nominal()


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    return session(43)


def shuffled(values: Array) -> Array:
    return np.random.default_rng(5).permutation(len(values))


def reordered(campaign: Campaign, order: Order, start: str) -> Campaign:
    """Return a campaign in which the rows of some columns of runs at rest come in another order."""
    runs = []
    for run in campaign.runs:
        columns = dict(run.columns)
        if run.kind == "static":
            columns |= {name: v[order(v)] for name, v in columns.items() if name.startswith(start)}
        runs.append(replace(run, columns=columns))
    return replace(campaign, runs=tuple(runs))


@pytest.mark.parametrize("order", [shuffled, np.argsort], ids=["shuffled", "sorted"])
@pytest.mark.parametrize("felt", [True, False], ids=["with a force sensor", "without"])
def test_places_in_another_order_are_told(
    campaign: Campaign, compiled: CompiledRobot, order: Order, felt: bool
) -> None:
    whole = campaign if felt else without_force(campaign)
    assert not doubts_of(whole, compiled)
    said = [str(one) for one in doubts_of(reordered(whole, order, "reflector"), compiled)]
    assert any("reflector_1" in one and "load" in one for one in said)


def test_repeats_that_are_copies_are_told_once(campaign: Campaign, compiled: CompiledRobot) -> None:
    assert not list(copied_repeats(Repeated.of(campaign, compiled)))
    runs = []
    for run in campaign.runs:
        if run.kind == "static":
            first = np.arange(len(run)) - (run.columns["repeat"].astype(int) - 1)
            measured = [name for name in run.columns if name.startswith(("current", "reflector", "force", "moment"))]
            run = replace(run, columns={**run.columns, **{name: run.columns[name][first] for name in measured}})
        runs.append(run)
    (finding,) = copied_repeats(Repeated.of(replace(campaign, runs=tuple(runs)), compiled))
    assert "to the last digit in all channels, and likewise in" in finding.message


def test_coarse_readings_may_agree(campaign: Campaign, compiled: CompiledRobot) -> None:
    """Rounded to a fifth of their noise or more, two channels agree by chance; nothing is said of that."""
    runs = []
    for run in campaign.runs:
        names = {name for name in run.columns if name.startswith(("current_1", "current_2", "current_3"))}
        other = {"current", "reflector", "force", "moment", "gas"}
        kept = {n: v for n, v in run.columns.items() if n in names or not n.startswith(tuple(other))}
        runs.append(replace(run, columns={n: np.round(v, 1) if n in names else v for n, v in kept.items()}))
    coarse = Repeated.of(replace(campaign, runs=tuple(runs)), compiled)
    states = next(run for run in coarse.campaign.of_kind("static"))
    same = np.all([np.diff(states.columns[f"current_{i}_a"]) == 0 for i in (1, 2, 3)], axis=0)
    assert same.any()  # or this shows nothing
    assert not list(copied_repeats(coarse))
