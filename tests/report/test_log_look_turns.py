"""A counter that stands some turns on, as that of a continuous joint: an offset, and no factor on other angles."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.record.convert import convert
from bench.record.log_format import LogFormat, read_log_format
from bench.record.look.families import Family
from bench.report.campaigns import plain_arm
from bench.report.log_look.angle_units import turns_of
from bench.report.log_look.look import Proposal, look
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.nominal_dynamics import NominalDynamics
from tests import seven_joints

TURN = 2 * np.pi
EVERY = range(1, seven_joints.N + 1)


def read(tmp_path: Path, proposal: Proposal) -> LogFormat:
    (tmp_path / "log.yaml").write_text(proposal.text)
    return read_log_format(tmp_path / "log.yaml")


def on(log: seven_joints.Log, joint: int, by: float) -> seven_joints.Log:
    return replace(log, angle=log.angle + by * (np.arange(1, seven_joints.N + 1) == joint))


@pytest.fixture
def continuous(tmp_path: Path) -> NominalDynamics:
    return seven_joints.started(tmp_path, without_range=(7,))


@pytest.mark.parametrize(
    ("turns", "name"), [(3, "A{}.pos"), (-2, "pos_{}_rad"), pytest.param(-2, "A{}.pos", marks=pytest.mark.study)]
)
def test_whole_turns_are_an_offset_of_that_joint_alone(
    tmp_path: Path, continuous: NominalDynamics, turns: int, name: str
) -> None:
    """Factors of 0.96 to 1.14 were written on all seven angles."""
    log = on(seven_joints.moved(continuous, np.random.default_rng(2)), 7, turns * TURN)
    file = log.written(tmp_path / "x.csv", angle=name)
    proposal = look(file, nominal=continuous)
    form = read(tmp_path, proposal)
    assert proposal.questions == ()
    assert [form.columns[f"q_motor_{j}_rad"].factor for j in EVERY] == [1] * 7
    assert [form.columns[f"q_motor_{j}_rad"].offset for j in EVERY[:-1]] == [0] * 6
    assert form.columns["q_motor_7_rad"].offset == pytest.approx(-turns * TURN, abs=1e-7)
    assert f"a counter that stands {abs(turns)} turns {'on' if turns > 0 else 'back'}" in proposal.text
    assert [form.columns[f"current_{j}_a"].factor for j in EVERY] == [1] * 7
    (run,) = convert(file, form, "mine", plain_arm(compile_robot(load_robot(tmp_path / "seven")))).campaign.runs
    assert np.max(np.abs(run.columns["q_motor_7_rad"])) < np.pi


def test_a_turned_joint_is_counted_back_the_other_way(tmp_path: Path, continuous: NominalDynamics) -> None:
    log = seven_joints.moved(continuous, np.random.default_rng(2))
    turned = replace(log, angle=log.angle * np.where(np.arange(1, 8) == 2, -1.0, 1.0))
    form = read(tmp_path, look(on(turned, 7, 2 * TURN).written(tmp_path / "x.csv"), nominal=continuous))
    assert [form.columns[f"q_motor_{j}_rad"].factor for j in EVERY] == [1, -1, 1, 1, 1, 1, 1]
    assert form.columns["q_motor_7_rad"].offset == pytest.approx(-2 * TURN, abs=1e-7)


def test_degrees_stay_degrees(tmp_path: Path) -> None:
    """Of joints with two turns to go, three of seven are beyond them as radians, and within but for whole turns.

    So small a motion does not tell which it is.
    """
    arm = seven_joints.started(tmp_path, without_range=tuple(EVERY))
    small = seven_joints.moved(arm, np.random.default_rng(2), size=0.01)
    log = replace(small, angle=np.rad2deg(small.angle))
    assert 0 < np.sum(np.max(np.abs(log.angle), axis=0) > 1.5 * TURN) <= 3
    names = tuple(f"A{j}.pos" for j in EVERY)
    assert turns_of(Family("position", False, names, "", ""), dict(zip(names, log.angle.T, strict=True)), arm)
    proposal = look(log.written(tmp_path / "x.csv"), nominal=arm)
    form = read(tmp_path, proposal)
    assert [form.columns[f"q_motor_{j}_rad"].factor for j in EVERY] == [pytest.approx(np.pi / 180)] * 7


def test_without_torques_it_asks(tmp_path: Path, continuous: NominalDynamics) -> None:
    log = on(seven_joints.moved(continuous, np.random.default_rng(2)), 7, 3 * TURN)
    still = replace(log, current=0 * log.current)
    proposal = look(still.written(tmp_path / "x.csv"), nominal=continuous)
    assert any("radians with a counter that stands 3 turns on?" in question for question in proposal.questions)


def test_no_factor_is_written_on_angles_that_no_gear_has(tmp_path: Path) -> None:
    """One joint that is out of its range by no turns: the others were bent by what masses and friction get wrong."""
    arm = seven_joints.started(tmp_path)
    log = on(seven_joints.moved(arm, np.random.default_rng(2)), 7, 20.0)
    form = read(tmp_path, look(log.written(tmp_path / "x.csv"), nominal=arm))
    told = [form.columns[name].factor for j in EVERY[:-1] if (name := f"q_motor_{j}_rad") in form.columns]
    assert told == [1] * 6
