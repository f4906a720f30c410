"""One run among others: a clock, a gain or a zero of its own is told, and nothing that two runs alone can settle."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.plausibility.channels import doubts_of
from bench.diagnose.plausibility.drive_picture import DrivePicture
from bench.diagnose.plausibility.hints import doubts_and_hints_of, hints_of
from bench.diagnose.plausibility.mistaken_run import _mistaken
from bench.diagnose.plausibility.one_run import _unlike
from bench.hide.campaign import hide_campaign
from bench.record.campaign import Array, Campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.scenario.files import read_scenario
from bench.store.place import open_store


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    hidden = hide_campaign(load_robot("hh150"), read_scenario("session-study"), (), np.random.default_rng(21))
    return hidden.campaign


@pytest.fixture(scope="module")
def compiled() -> CompiledRobot:
    return compile_robot(load_robot("hh150"))


def changed(campaign: Campaign, run: str, column: str, change: Callable[[Array], Array]) -> Campaign:
    """Return a campaign with one column of one run changed."""
    runs = [
        replace(one, columns={**one.columns, column: change(one.columns[column])}) if one.name == run else one
        for one in campaign.runs
    ]
    return replace(campaign, runs=tuple(runs))


def said_of(campaign: Campaign, compiled: CompiledRobot) -> list[str]:
    return [str(finding) for finding in doubts_and_hints_of(campaign, compiled, store=open_store())]


def test_nothing_is_said_of_a_healthy_session(campaign: Campaign, compiled: CompiledRobot) -> None:
    assert not said_of(campaign, compiled)


@pytest.mark.parametrize(
    ("run", "column", "change", "words"),
    [
        ("joint2-payload100-speed40-up", "time_s", lambda t: 1.1 * t, "time_s: counts 1.09 seconds for each second"),
        pytest.param("loaded-out", "time_s", lambda t: 0.7 * t, "time_s: counts 0.8", marks=pytest.mark.study),
        ("joint2-payload50-speed18-up", "current_2_a", lambda v: 2 * v, "current_2_a: is 2.0"),
        ("joint2-payload50-speed40-down", "current_2_a", lambda v: v - 3, "current_2_a: is -3.0"),
        ("joint3-payload0-speed20-up", "current_3_a", lambda v: -v, "current_3_a: has the wrong sign"),
        ("pose2-from-below", "current_2_a", lambda v: -v, "current_2_a: has the wrong sign"),
    ],
)
def test_one_run_is_told(
    run: str, column: str, change: Callable[[Array], Array], words: str, campaign: Campaign, compiled: CompiledRobot
) -> None:
    (said,) = said_of(changed(campaign, run, column, change), compiled)
    assert words in said
    assert f"in run {run!r}" in said


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (None, "current_2_a: has the wrong sign"),
        ("current_3_a", "current_2_a: current_2_a and current_3_a are exchanged"),
    ],
)
def test_several_runs_are_told(other: str | None, words: str, campaign: Campaign, compiled: CompiledRobot) -> None:
    """Each stands among the others that are mistaken; one was told its clock, and causes were named at 100 %."""
    names = [run.name for run in campaign.runs if run.kind == "motion"][::3]
    runs = []
    for run in campaign.runs:
        here = run.columns
        if run.name in names:
            exchanged = {"current_2_a": here[other], other: here["current_2_a"]} if other else {}
            here = {**here, **(exchanged or {"current_2_a": -here["current_2_a"]})}
        runs.append(replace(run, columns=here))
    (said,) = (str(one) for one in doubts_of(replace(campaign, runs=tuple(runs)), compiled))
    assert words in said
    assert "and not in all others" in said
    assert {name for name in names if name in said}
    assert not {run.name for run in campaign.runs if f"'{run.name}'" in said} - set(names)


def test_friction_that_a_servo_turned_round_at_rest_is_no_wrong_sign(
    campaign: Campaign, compiled: CompiledRobot
) -> None:
    """Settling took a motor back until its friction held the other way: a sound recording was refused for it."""
    (level,) = (compiled.motor_coulomb + compiled.link_coulomb)[4:5] / compiled.torque_constant[4]
    held = changed(campaign, "pose4-from-above", "current_5_a", lambda v: v + 1.6 * level)
    assert not said_of(held, compiled)


def test_of_two_runs_that_contradict_each_other_none_is_blamed(campaign: Campaign, compiled: CompiledRobot) -> None:
    """Two sweeps alone tell the inertia of joint 3, which four lines move as well: which clock is off is not known."""
    names = ("joint3-payload0-speed50-up", "joint3-payload0-speed50-down")
    others = [run for run in campaign.runs if not run.name.startswith("joint3") or run.name in names]
    few = replace(campaign, runs=tuple(others))
    assert not said_of(changed(few, names[0], "time_s", lambda t: 1.3 * t), compiled)


def test_a_drive_that_reads_nothing_at_all_is_no_traceback(campaign: Campaign, compiled: CompiledRobot) -> None:
    still = campaign
    for run in campaign.runs:
        still = changed(still, run.name, "current_6_a", np.zeros_like)
    assert hints_of(still, compiled, store=open_store()) is not None


def test_without_a_torque_or_a_current_that_is_the_reason(campaign: Campaign, compiled: CompiledRobot) -> None:
    """It was said to be a lack of rests and of motions that go on, with the advice to move for longer."""
    known = ("time_s", "q_cmd", "q_motor")
    runs = tuple(
        replace(run, columns={name: v for name, v in run.columns.items() if name.startswith(known)})
        for run in campaign.runs
    )
    (hint,) = hints_of(replace(campaign, runs=runs), compiled, store=open_store())
    assert "no drive torque or current is recorded" in str(hint)
    assert "move for longer" not in str(hint)


@pytest.mark.parametrize("way", ["up", pytest.param("down", marks=pytest.mark.study)])
def test_a_slow_sweep_is_not_blamed_for_a_zero_of_the_fast_one(
    way: str, campaign: Campaign, compiled: CompiledRobot
) -> None:
    """Four sweeps move joint 6; without the fast one that is off, the other three explain each other."""
    culprit = f"joint6-payload0-speed50-{way}"
    moved = changed(campaign, culprit, "current_6_a", lambda v: v + 1.5)
    for said in said_of(moved, compiled):
        assert "speed20" not in said or (repr(culprit) in said and "nothing tells which" in said)


@pytest.mark.parametrize("another", [45.0, 2.0])
@pytest.mark.parametrize(("off", "is_told"), [(1, False), (4, True)])
def test_one_reading_at_rest_turns_no_sign(off: int, is_told: bool, another: float) -> None:
    """A healthy campaign was refused: joint 1 held 120 Nm where it was put first, and next to nothing later on.

    Where friction at rest explains all the others altogether, four readings were not told: nothing was divided by.
    """
    runs, rows = 6, 5
    model = np.full((runs * rows, 1), -35.0)
    observed = model + np.tile([[2.0], [-1.0], [0.5], [1.5], [-2.0]], (runs, 1))
    observed[:rows] = np.array([[-2.0], [-1.0], [-3.0], [-4.0], [-2.0]])
    observed[:off] = 120.0
    observed[rows] = another  # 45: another one holds a little more than friction in motion, too
    picture = DrivePicture(
        observed=observed,
        model=model,
        velocity=np.zeros_like(model),
        standing=np.ones(model.shape, dtype=np.bool_),
        slack=np.full(1, 200.0),
        level=np.full(1, 33.0),
        spare=np.zeros((2, 1)),
        unit=np.ones(1),
        missing=np.zeros((*model.shape, 0)),
        names=("current_1_a",),
    )
    found = _mistaken(picture, np.repeat(np.arange(runs), rows), 0, range(1, runs))
    assert bool(found) == is_told


def test_a_run_of_which_the_others_determine_nothing_is_like_them() -> None:
    """A poisoner's healthy runs of twenty rows ended `bench check` with a traceback."""
    columns = np.random.default_rng(1).standard_normal((4, 7))
    assert not _unlike(columns, np.ones(7), np.ones(4), np.eye(7), np.eye(4)).is_told
