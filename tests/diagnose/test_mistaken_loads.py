"""Loads in another direction or of another step, where no force sensor says so: drives paid for other changes."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.plausibility.channels import doubts_of
from bench.record.campaign import Array, Campaign
from bench.record.finding import Finding
from tests.diagnose.noise_free import noise_free
from tests.diagnose.sweeps import nominal

Change = Callable[[dict[str, Array]], dict[str, Array]]


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    """Return a session whose forces nobody measured."""
    made = noise_free("session-study", 5)
    sensed = ("force_", "moment_")
    runs = (
        replace(run, columns={name: v for name, v in run.columns.items() if not name.startswith(sensed)})
        for run in made.runs
    )
    return replace(made, runs=tuple(runs))


def doubts(campaign: Campaign, change: Change) -> tuple[Finding, ...]:
    runs = (
        replace(run, columns=run.columns | change(dict(run.columns))) if run.kind == "static" else run
        for run in campaign.runs
    )
    return doubts_of(replace(campaign, runs=tuple(runs)), nominal())


def turned(columns: dict[str, Array]) -> dict[str, Array]:
    """Return loads turned by a quarter of a turn, x to y."""
    return {"load_x_n": -columns["load_y_n"], "load_y_n": columns["load_x_n"]}


def late(columns: dict[str, Array]) -> dict[str, Array]:
    """Return each load at the next step."""
    repeats = int(np.sum(columns["load_step"] == columns["load_step"][0]))
    names = [name for name in columns if name.startswith("load_") and name != "load_step"]
    return {name: np.concatenate([columns[name][:repeats], columns[name][:-repeats]]) for name in names}


def test_loads_that_drives_paid_for_are_believed(campaign: Campaign) -> None:
    assert not doubts(campaign, lambda columns: {})


@pytest.mark.parametrize(
    ("change", "column", "words"),
    [(turned, "load_x_n", "turned by +90 degrees"), (late, "load_z_n", "one load step late")],
)
def test_loads_that_drives_did_not_pay_for_are_told(
    campaign: Campaign, change: Change, column: str, words: str
) -> None:
    (found,) = doubts(campaign, change)
    assert found.column == column
    assert words in found.message
