"""A tracker that is farther off than anything listed, and nearer than another unit or frame."""

import re
from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.plausibility.channels import doubts_of
from bench.record.campaign import Campaign
from bench.record.finding import Finding
from bench.robot.compiled import compile_robot
from tests.diagnose.sweeps import LOADS, SWEEPS, changed, made, nominal, scale


def shifted(campaign: Campaign, by: float, runs: slice = slice(None)) -> Campaign:
    """Return a campaign in which z of the reflectors is off by so much [m] in some runs."""
    there = {run.name for run in campaign.runs[runs]}

    def off(name: str, values: np.ndarray) -> np.ndarray:
        return values + by if name.startswith("reflector") and name.endswith("z_m") else values

    return replace(
        campaign,
        runs=tuple(
            replace(run, columns={key: off(key, values) for key, values in run.columns.items()})
            if run.name in there
            else run
            for run in campaign.runs
        ),
    )


def said(campaign: Campaign) -> list[Finding]:
    return [one for one in doubts_of(campaign, nominal()) if one.column.startswith("reflector")]


@pytest.mark.parametrize(("by", "level"), [(0.0, ""), (0.003, ""), (0.05, "warning"), (0.4, "doubt")])
def test_a_frame_that_is_off_everywhere_is_told_with_its_shift(by: float, level: str) -> None:
    """50 mm were believed: jumps of the tracker and slips of joint 5 came out at 100 %."""
    found = said(shifted(made(LOADS, seed=5), by))
    assert {one.level for one in found} == ({level} if level else set())
    if level == "warning":
        where = re.search(r"by ([+-]\d+) mm in x, ([+-]\d+) mm in y, ([+-]\d+) mm in z", found[0].message)
        assert where
        np.testing.assert_allclose([int(one) for one in where.groups()], [0, 0, 50], atol=2)
        assert "nothing that is listed puts it so far off" in found[0].message


def exchanged(campaign: Campaign, one: str, two: str, after: int = 0) -> Campaign:
    """Return a campaign in whose last run the columns that two words tell apart are exchanged, from a row on."""
    columns = {key: np.array(values) for key, values in campaign.runs[-1].columns.items()}
    for name in [name for name in columns if one in name]:
        other = name.replace(one, two)
        columns[name][after:], columns[other][after:] = columns[other][after:], columns[name][after:].copy()
    return replace(campaign, runs=(*campaign.runs[:-1], replace(campaign.runs[-1], columns=columns)))


@pytest.mark.parametrize(
    ("one", "two", "half", "words"),
    [
        ("_x_m", "_y_m", False, "the model's x, y, z are read as y, x, z in run"),
        ("reflector_1", "reflector_2", False, "lies where the model has reflector 2 in run"),
        ("reflector_1", "reflector_2", True, "lies where the model has reflector 2 in a part of run"),
    ],
)
def test_what_was_exchanged_in_one_run_is_told_as_that(one: str, two: str, half: bool, words: str) -> None:
    """Zeros and signs of joints were blamed for columns that fit when they are exchanged."""
    campaign = made(LOADS.model_copy(update={"orientation": True}), seed=5)
    rows = len(next(iter(campaign.runs[-1].columns.values())))
    found = said(exchanged(campaign, one, two, after=2 * rows // 5 if half else 0))
    assert found[0].level == "doubt"
    assert f"{words} {campaign.runs[-1].name!r}, and not in all others" in found[0].message
    assert not [one for one in found if "sign of the joints" in str(one)]


def test_a_tracker_that_was_moved_between_runs_is_told_with_the_run() -> None:
    campaign = made(LOADS, seed=5)
    found = said(shifted(campaign, 0.03, slice(-1, None)))
    assert [one.level for one in found] == ["warning"] * len(found)
    assert f"in run {campaign.runs[-1].name!r}, and not in all others" in found[0].message


@pytest.mark.parametrize(("geometry_m", "is_doubted"), [(0.2e-3, True), (2e-3, False)])
def test_links_may_be_as_much_longer_as_places_of_joints_are_known(geometry_m: float, *, is_doubted: bool) -> None:
    """Of an arm that was measured with a tape, 1.2 % more travel was taken for another unit of the tracker."""
    compiled = nominal()
    figures = compiled.robot.figures
    known = figures.uncertainty.model_copy(update={"geometry_m": geometry_m})
    rough = compile_robot(replace(compiled.robot, figures=figures.model_copy(update={"uncertainty": known})))
    longer = changed(made(SWEEPS, seed=5), scale(1.012, *(f"reflector_1_{axis}_m" for axis in "xyz")))
    told = [doubt for doubt in doubts_of(longer, rough) if doubt.level == "doubt"]
    assert [doubt.column for doubt in told] == ["reflector_1_x_m"] * is_doubted
