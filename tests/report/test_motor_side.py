"""Logs with angles of the motors: what `bench convert --look` proposes for them, and that convert takes it."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from bench.identify.angle_scale import AngleScale
from bench.record.convert import convert
from bench.record.look.families import Family
from bench.report.log_look import gears
from bench.report.log_look.angle_units import angle_unit
from bench.report.log_look.look import look
from bench.robot.nominal_dynamics import NominalDynamics, nominal_dynamics
from bench.robot.starter.folder import start_robot
from bench.robot.starter.source import read_source
from tests import stranger
from tests.report.proposals import proposed

DEGREE = np.pi / 180
JOINTS = (1, 2, 3)
RATIO = (50.0, 121.0, 200.0)
SIGMAS = 3.0  # standard deviations by which an estimate may be off
SLACK = 0.01  # relative: percentages are rounded to one


def log(
    file: Path, motion: stranger.Motion, ratio: tuple[float, ...], unit: str, header: bool, command: float = 0.0
) -> Path:
    """Write angles of the motors and currents; with a command at the joints in degrees where one is wanted."""
    angle = motion.position * ratio / (DEGREE if unit == "deg" else 1.0)
    current = motion.torque / np.array(stranger.CONSTANT)
    names = ["t[s]", *(f"A{j}_mot[{unit}]" for j in JOINTS), *(f"I{j}[A]" for j in JOINTS)]
    columns = [motion.time, angle, current]
    if command:
        names += [f"A{j}_soll[deg]" for j in JOINTS]
        columns.append(command * motion.position / DEGREE)
    head = ";".join(names) if header else ""
    np.savetxt(file, np.column_stack(columns), delimiter=";", header=head, comments="", fmt="%.8g")
    return file


@pytest.fixture(scope="module")
def motion() -> stranger.Motion:
    return stranger.moved(np.random.default_rng(5), 20.0, stranger.as_filed(2.0))


@pytest.mark.parametrize(
    ("ratio", "unit", "header"),
    [
        pytest.param(ratio, unit, header, marks=() if (unit == "deg") == header else pytest.mark.study)
        for ratio in (RATIO, (-160.0, 160.0, -100.0))
        for unit in ("deg", "rad")
        for header in (True, False)
    ],
)
def test_gear_ratios_are_estimated_with_their_intervals(
    tmp_path: Path, arm: NominalDynamics, motion: stranger.Motion, unit: str, header: bool, ratio: tuple[float, ...]
) -> None:
    """Factors for degrees at the joints were proposed without a word, and convert refused them."""
    file = log(tmp_path / "x.csv", motion, ratio, unit, header)
    proposal = look(file, nominal=arm)
    form = proposed(tmp_path, proposal.text)
    told = re.findall(r"q_motor_(\d)_rad: .*gear ratio ([\d.e+]+).*?\+- (\d+) %, estimated from torques", proposal.text)
    assert [number for number, _, _ in told] == ["1", "2", "3"]
    for joint, (_, _, percent) in enumerate(told):
        found = form.columns[f"q_motor_{joint + 1}_rad"].factor * abs(ratio[joint]) / (DEGREE if unit == "deg" else 1)
        assert abs(abs(found) - 1) < SIGMAS * float(percent) / 100 + SLACK
    assert "write the true ones" in proposal.questions[0]
    assert not any("refuse" in question or "doubt" in question for question in proposal.questions)
    assert "reaches" not in proposal.text or "so degrees" not in proposal.text
    (run,) = convert(file, form, "mine").campaign.runs
    assert np.max(np.abs(run.columns["q_motor_2_rad"])) < 2.6  # its limit


@pytest.mark.parametrize(("unit", "header"), [("deg", True), ("deg", False), ("rad", True), ("rad", False)])
def test_angles_of_the_joints_stay_as_they_are(tmp_path: Path, unit: str, header: bool) -> None:
    """Also of an arm that is far from its file, where other scales explain the torque a little better."""
    (tmp_path / "arm.xml").write_text(stranger.mjcf(armature=5.0))
    guessed = nominal_dynamics(start_robot("arm", read_source(tmp_path / "arm.xml"), tmp_path / "arm").compiled)
    rng = np.random.default_rng(4)
    motion = stranger.moved(rng, 15.0, stranger.unlike_its_file(rng))
    file = log(tmp_path / "x.csv", motion, (1.0, 1.0, 1.0), unit, header)
    proposal = look(file, nominal=guessed)
    form = proposed(tmp_path, proposal.text)
    expected = DEGREE if unit == "deg" else 1.0
    np.testing.assert_allclose([abs(form.columns[f"q_motor_{j}_rad"].factor) for j in JOINTS], expected)
    assert proposal.questions == ()


@pytest.mark.parametrize("header", ["Grad", "deg", ""])
def test_joint_degrees_are_not_divided_by_stated_gear_ratios(
    tmp_path: Path, arm: NominalDynamics, motion: stranger.Motion, header: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Scales as torques told them of an arm with 6 kg too much and masses that were 20 % off: no gear, so degrees.

    They fit twice as well as none, which was enough to take the angles for radians of the motors.
    """
    bent = AngleScale(np.array([0.8, 0.93, 0.85]), np.array([0.09, 0.013, 0.018]), 0.0146, 0.0369)
    monkeypatch.setattr(gears, "angle_scale", lambda *_: bent)
    file = log(tmp_path / "x.csv", motion, (1.0, 1.0, 1.0), "deg", bool(header))
    file.write_text(file.read_text().replace("_mot[deg]", f"[{header}]"))
    stated = replace(arm, gear_ratio=np.array([121.0, 141.0, 121.0]))
    form = proposed(tmp_path, look(file, nominal=stated).text)
    np.testing.assert_allclose([abs(form.columns[f"q_motor_{j}_rad"].factor) for j in JOINTS], DEGREE)


def test_a_gear_ratio_of_the_figures_is_used_as_it_is(
    tmp_path: Path, arm: NominalDynamics, motion: stranger.Motion
) -> None:
    stated = replace(arm, gear_ratio=np.array(RATIO))
    for unit, header in (("deg", True), ("deg", False), ("rad", False)):
        proposal = look(log(tmp_path / "x.csv", motion, RATIO, unit, header), nominal=stated)
        form = proposed(tmp_path, proposal.text)
        factors = [form.columns[f"q_motor_{j}_rad"].factor for j in JOINTS]
        np.testing.assert_allclose(factors, (DEGREE if unit == "deg" else 1) / np.array(RATIO))
        assert "gear ratio 121 of the figures" in proposal.text
        assert proposal.questions == ()


def test_a_command_at_the_joints_tells_the_gear_ratio(
    tmp_path: Path, arm: NominalDynamics, motion: stranger.Motion
) -> None:
    proposal = look(log(tmp_path / "x.csv", motion, (50.0, -121.0, 200.0), "deg", True, command=1.0), nominal=arm)
    form = proposed(tmp_path, proposal.text)
    factors = [form.columns[f"q_motor_{j}_rad"].factor for j in JOINTS]
    np.testing.assert_allclose(factors, DEGREE / np.array([50, -121, 200]), rtol=1e-4)
    assert [form.columns[f"q_cmd_{j}_rad"].factor for j in JOINTS] == pytest.approx([DEGREE] * 3)
    assert "gear ratio 121, as A2_soll[deg] has it" in proposal.text


@pytest.mark.parametrize("header", [True, False])
def test_what_nothing_tells_is_asked(
    tmp_path: Path, motion: stranger.Motion, header: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without a robot there are no torques to hold angles against; convert refuses only what --look has said."""
    unit = "deg" if header else "rad"
    file = log(tmp_path / "x.csv", motion, (5000.0,) * 3 if not header else RATIO, unit, header)
    assert main(["convert", "--look", str(file), "-o", str(tmp_path / "log.yaml")]) == 0
    said = capsys.readouterr().out
    assert "motor side? angles reach" in said
    assert ("write 0.01745329252 / N as the factor" if header else "write 1 / N, or in degrees") in said
    assert "bench convert will refuse this as it stands" in said
    assert "# q_motor_1_rad: " in (tmp_path / "log.yaml").read_text()
    assert main(["convert", "emps", str(file), "--log", str(tmp_path / "log.yaml"), "-o", str(tmp_path / "c")]) == 3


def test_one_joint_alone_does_not_tell_the_others(
    tmp_path: Path, arm: NominalDynamics, motion: stranger.Motion
) -> None:
    still = replace(motion, position=motion.position * [1, 0, 0] + [0, 0.3, -0.4])
    proposal = look(log(tmp_path / "x.csv", still, RATIO, "deg", True), nominal=arm)
    assert any(
        "A1_mot[deg]" in q and "(joint j1 149)" in q and "not tell the gear ratios N" in q for q in proposal.questions
    )
    assert any("refuse" in question for question in proposal.questions)


def test_one_joint_that_goes_further_than_its_model_is_no_gear() -> None:
    """A wrist that turns twice as far as its limit says; the other five are in range in degrees."""
    family = Family("position", False, tuple("abcdef"), "deg", "")
    columns = {name: np.array([-60.0, 60.0]) for name in "abcde"} | {"f": np.array([0.0, 700.0])}
    reach = np.array([3.0] * 5 + [6.1])
    assert angle_unit(family, columns, reach, True).side == "joint"
    assert angle_unit(family, columns | {"a": np.array([0.0, 3000.0])}, reach, True).side == "motor"


def test_a_reason_stands_once_and_a_sign_is_said_as_it_is(
    tmp_path: Path, arm: NominalDynamics, motion: stranger.Motion
) -> None:
    """It said "unit deg in its name; unit deg in its name", and "sign as the model has it" beside a factor of -1."""
    rows = np.column_stack([motion.time, motion.position / DEGREE, motion.torque / np.array(stranger.CONSTANT)])
    names = ["t[s]", *(f"A{j}[deg]" for j in JOINTS), *(f"I{j}[A]" for j in JOINTS)]
    np.savetxt(tmp_path / "x.csv", rows, delimiter=",", header=",".join(names), comments="", fmt="%.8g")
    lines = look(tmp_path / "x.csv", nominal=arm).text.splitlines()
    (first,) = [line for line in lines if "q_motor_1_rad" in line]
    assert first.count("unit deg in its name") == 1
    (plain,) = [line for line in lines if "current_1_a" in line]
    (turned,) = [line for line in lines if "current_2_a" in line]
    assert "sign as the model has it" in plain
    assert "factor: -1" in turned
    assert "turned" in turned
    assert "sign as the model has it" not in turned
