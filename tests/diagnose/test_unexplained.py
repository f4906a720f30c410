"""What a whole campaign hides and one run shows: hints about channels that the model does not explain."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.plausibility.channels import doubts_of
from bench.diagnose.plausibility.hints import doubts_and_hints_of
from bench.record.campaign import Array, Campaign, Run
from bench.record.finding import Finding
from bench.record.known import Known
from bench.record.write import write_campaign
from bench.report.campaigns import open_campaign
from bench.robot.compiled import CompiledRobot
from bench.scenario.files import read_as
from bench.scenario.session import SessionScenario
from bench.store.place import open_store
from tests.diagnose.sweeps import made

RUN = "joint2-payload50-speed24-up"
DRIVES = tuple(f"current_{j}_a" for j in range(1, 7))


@pytest.fixture(scope="module")
def session() -> Campaign:
    return made(read_as(SessionScenario, "session-short"), seed=5)


def with_columns(run: Run, **columns: Array) -> Run:
    return replace(run, columns={**run.columns, **columns})


def turned(run: Run) -> Run:
    return with_columns(run, current_2_a=-run.columns["current_2_a"]) if run.name == RUN else run


def backwards(run: Run) -> Run:
    others = {name: values[::-1] for name, values in run.columns.items() if name != "time_s"}
    return with_columns(run, **others) if run.name == RUN else run


def without_sign(run: Run) -> Run:
    return with_columns(run, current_6_a=np.abs(run.columns["current_6_a"]))


def hints(campaign: Campaign, robot: CompiledRobot) -> list[Finding]:
    found = doubts_and_hints_of(campaign, robot, store=open_store())
    assert not any(finding.level == "doubt" for finding in found)
    return list(found)


def test_healthy_runs_say_nothing(session: Campaign, robot: CompiledRobot) -> None:
    assert hints(session, robot) == []


@pytest.mark.parametrize(
    ("change", "column", "where"),
    [(backwards, "current_2_a", RUN)],
)
def test_a_run_that_the_model_does_not_explain_is_told(
    change: object, column: str, where: str, session: Campaign, robot: CompiledRobot
) -> None:
    assert callable(change)
    told = hints(replace(session, runs=tuple(change(run) for run in session.runs)), robot)
    assert column in [hint.column for hint in told]
    assert where in next(hint.message for hint in told if hint.column == column)


@pytest.mark.parametrize(
    ("change", "column", "words"),
    [
        (turned, "current_2_a", f"has the wrong sign in run {RUN!r}"),
        (without_sign, "current_6_a", "is nowhere negative"),
    ],
)
def test_what_a_channel_is_taken_for_is_told(
    change: Callable[[Run], Run], column: str, words: str, session: Campaign, robot: CompiledRobot
) -> None:
    (doubt,) = doubts_of(replace(session, runs=tuple(change(run) for run in session.runs)), robot)
    assert doubt.column == column
    assert words in doubt.message


def test_channels_that_are_all_scaled_alike_are_told(session: Campaign, robot: CompiledRobot) -> None:
    runs = (with_columns(run, **{name: 0.37 * run.columns[name] for name in DRIVES}) for run in session.runs)
    (hint, *_) = (hint for hint in hints(replace(session, runs=tuple(runs)), robot) if "looks scaled" in hint.message)
    assert "about 0.37 times what the model needs" in hint.message


def test_a_gauge_that_stops_half_way_is_doubted(session: Campaign, robot: CompiledRobot) -> None:
    def stopped(run: Run) -> Run:
        pressure = run.columns["gas_pressure_pa"].copy()
        pressure[len(pressure) // 2 :] = pressure[len(pressure) // 2]
        return with_columns(run, gas_pressure_pa=pressure) if run.name == RUN else run

    (doubt,) = doubts_of(replace(session, runs=tuple(stopped(run) for run in session.runs)), robot)
    assert (doubt.column, RUN in doubt.message) == ("gas_pressure_pa", True)


def test_a_clock_that_is_far_too_fast_is_named_before_anything_is_simulated(
    session: Campaign, robot: CompiledRobot
) -> None:
    def fast(run: Run) -> Run:
        return with_columns(run, time_s=1e-12 * run.columns["time_s"]) if run.name == RUN else run

    (doubt,) = doubts_of(replace(session, runs=tuple(fast(run) for run in session.runs)), robot)
    assert RUN in doubt.message
    assert "milliseconds in time_s?" in doubt.remedy


@pytest.mark.parametrize(
    ("known", "key", "words"),
    [
        (Known("stiffness_nm_per_rad", 1e6, 1e5, joint=7), "known[0].joint", "hh150 has 6 joints, not 7"),
        (Known("gas_pressure_pa", 1e7, 1e5, at=(0.0, 0.0)), "known[0].at", "each of the 6 joints"),
        (Known("gas_pressure_pa", 1e7, 1e5, at=(0.0, -90.0, 0.0, 0.0, 0.0, 0.0)), "known[0].at", "not to -90"),
    ],
)
def test_check_tells_what_the_robot_cannot_have(
    known: Known, key: str, words: str, session: Campaign, tmp_path: Path
) -> None:
    write_campaign(replace(session, known=(known,)), tmp_path / "campaign")
    report, _ = open_campaign(tmp_path / "campaign")
    (error,) = report.errors
    assert (error.file, error.column) == ("campaign.yaml", key)
    assert words in error.message
