"""One of three runs: what the two others say of it, each by itself, is told, and nothing that they do not determine."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.plausibility.hints import doubts_and_hints_of
from bench.hide.campaign import hide_campaign
from bench.record.campaign import Array, Campaign, Run
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.scenario.files import read_scenario
from tests import stranger
from tests.stranger_started import started

Columns = dict[str, Array]
RUNS = ("first", "second", "third")
EACH = 5  # rows of what moved, of which one is logged: 100 Hz


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> CompiledRobot:
    folder = tmp_path_factory.mktemp("stranger")
    started(folder)
    return compile_robot(load_robot(folder / "arm"))


def recorded(seed: int, is_as_filed: bool) -> Campaign:
    """Return a stranger's campaign of three motions of 6 s."""
    rng = np.random.default_rng(seed)
    moving = stranger.as_filed(2.5) if is_as_filed else stranger.unlike_its_file(rng)
    runs = []
    for number, name in enumerate(RUNS):
        motion = stranger.moved(rng, 6.0, moving)
        columns = {"time_s": motion.time[::EACH]}
        for j in range(3):
            columns[f"q_motor_{j + 1}_rad"] = motion.position[::EACH, j]
            columns[f"tau_motor_{j + 1}_nm"] = motion.torque[::EACH, j]
        runs.append(Run(name, "motion", 100.0 * number, columns))
    return Campaign("arm", tuple(runs))


def said_of(campaign: Campaign, compiled: CompiledRobot) -> list[str]:
    return [str(finding) for finding in doubts_and_hints_of(campaign, compiled)]


def scaled(factor: float, *drives: int) -> Callable[[Columns], Columns]:
    return lambda columns: {f"tau_motor_{j}_nm": factor * columns[f"tau_motor_{j}_nm"] for j in drives}


def noise(columns: Columns) -> Columns:
    rng = np.random.default_rng(1)
    return {"tau_motor_2_nm": columns["tau_motor_2_nm"] + 100 * rng.normal(size=len(columns["time_s"]))}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (scaled(1.5, 1), "tau_motor_1_nm: is 1."),
        (scaled(2.0, 2), "tau_motor_2_nm: is "),
        (scaled(2.5, 1, 2, 3), "tau_motor_2_nm: is 2."),
        (lambda columns: {"tau_motor_2_nm": columns["tau_motor_2_nm"] + 30}, "tau_motor_2_nm: is +"),
        (noise, "tau_motor_2_nm: is hardly"),
    ],
)
@pytest.mark.parametrize("is_as_filed", [True, False])
def test_one_of_three_is_told(
    change: Callable[[Columns], Columns], words: str, is_as_filed: bool, arm: CompiledRobot
) -> None:
    """Nothing was said of it: three others had to be there."""
    campaign = recorded(1, is_as_filed)
    second = campaign.runs[1]
    spoilt = replace(second, columns={**second.columns, **change(dict(second.columns))})
    said = said_of(replace(campaign, runs=(campaign.runs[0], spoilt, campaign.runs[2])), arm)
    assert any(words in one and "in run 'second'" in one for one in said), said
    assert not any("'first'" in one or "'third'" in one for one in said)


@pytest.mark.parametrize("is_as_filed", [True, False])
def test_nothing_is_said_of_three_healthy_ones(is_as_filed: bool, arm: CompiledRobot) -> None:
    assert not said_of(recorded(2, is_as_filed), arm)


def test_what_two_others_do_not_determine_a_run_may_have() -> None:
    """Two sweeps upwards do not tell friction from a zero; the one downwards was said to have another zero."""
    robot = load_robot("hh150")
    session = hide_campaign(robot, read_scenario("session-study"), (), np.random.default_rng(21)).campaign
    names = [f"joint5-payload0-speed{speed}" for speed in ("20-up", "20-down", "50-up")]
    few = replace(session, runs=tuple(run for run in session.runs if run.name in names))
    assert len(few.runs) == len(names)
    assert not said_of(few, compile_robot(robot))
