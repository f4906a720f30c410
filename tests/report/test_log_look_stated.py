"""What names and figures state of a log is used: units, gear ratios, torque constants; what nothing tells is said."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from bench.record.look.names import families_by_name, rate_of
from bench.report.log_look.look import look
from bench.robot.nominal_dynamics import NominalDynamics
from tests import stranger
from tests.report.proposals import proposed

JOINTS = (1, 2, 3)
RATIO = np.array([50.0, 121.0, 200.0])
CONSTANT = np.abs(stranger.CONSTANT)
ESTIMATE = 0.1  # relative: masses as in the file, so constants are told to a few percent


@pytest.fixture(scope="module")
def motion() -> stranger.Motion:
    return stranger.moved(np.random.default_rng(5), 15.0)


def log(file: Path, motion: stranger.Motion, position: str, reading: str, readings: np.ndarray) -> Path:
    names = ["t", *(position.format(j) for j in JOINTS), *(reading.format(j) for j in JOINTS)]
    rows = np.column_stack([motion.time, motion.position, readings])
    np.savetxt(file, rows, delimiter=",", header=",".join(names), comments="", fmt="%.9g")
    return file


@pytest.mark.parametrize(("unit", "factor"), [("kNm", 1e3), ("Nmm", 1e-3), ("Nm", 1.0)])
def test_the_unit_in_the_name_of_a_torque_is_its_factor(
    tmp_path: Path, arm: NominalDynamics, motion: stranger.Motion, unit: str, factor: float
) -> None:
    """A factor of 1060 +- 6 % was fitted in place of 1000."""
    file = log(tmp_path / "x.csv", motion, "q{}", "tau{}_" + unit, motion.torque / factor)
    form = proposed(tmp_path, look(file, nominal=arm).text)
    assert [form.columns[f"tau_motor_{j}_nm"].factor for j in JOINTS] == [factor] * 3


def test_milliamperes_are_scaled_beside_a_robot_too(
    tmp_path: Path, arm: NominalDynamics, motion: stranger.Motion
) -> None:
    """They stood as A, and a torque constant a thousand times too small was offered."""
    file = log(tmp_path / "x.csv", motion, "q{}", "I{}_mA", 1e3 * motion.torque / np.array(stranger.CONSTANT))
    text = look(file, nominal=arm).text
    form = proposed(tmp_path, text)
    assert [form.columns[f"current_{j}_a"].factor for j in JOINTS] == [1e-3, -1e-3, 1e-3]
    told = text.split("torque_constant_nm_per_a as estimated: ")[1].split("\n")[0]
    np.testing.assert_allclose([float(part.split()[1]) for part in told.split(", ")], CONSTANT, rtol=ESTIMATE)


def test_torques_that_are_smaller_than_their_unit_says_keep_it(
    tmp_path: Path, arm: NominalDynamics, motion: stranger.Motion
) -> None:
    file = log(tmp_path / "x.csv", motion, "q{}", "tau{}_kNm", motion.torque)
    text = look(file, nominal=arm).text
    form = proposed(tmp_path, text)
    assert [form.columns[f"tau_motor_{j}_nm"].factor for j in JOINTS] == [1e3] * 3
    assert "unit knm in the name of tau1_kNm to tau3_kNm is used, but this log contradicts it" in text
    told = text.split("Model by reading: ")[1].split("\n")[0]
    np.testing.assert_allclose([float(part.split()[1]) for part in told.split(", ")], 1e-3, rtol=ESTIMATE)


def test_stated_gear_ratios_are_the_factors_of_motor_torques(
    tmp_path: Path, arm: NominalDynamics, motion: stranger.Motion
) -> None:
    file = log(tmp_path / "x.csv", motion, "q{}", "motor_torque_{}", motion.torque / RATIO * [1, -1, 1])
    text = look(file, nominal=replace(arm, gear_ratio=RATIO)).text
    form = proposed(tmp_path, text)
    assert [form.columns[f"tau_motor_{j}_nm"].factor for j in JOINTS] == [50, -121, 200]
    assert "are estimates" not in text
    assert "contradicts" not in text
    text = look(file, nominal=replace(arm, gear_ratio=RATIO * [1, 2, 1])).text
    assert proposed(tmp_path, text).columns["tau_motor_2_nm"].factor == -242
    (told,) = re.findall(
        r"gear_ratio of the figures is used, but this log contradicts it: j2 242 stated, (.*) by", text
    )
    size, sigma = re.fullmatch(r"([\d.]+) \+- (\d+) %", told).groups()
    assert abs(float(size) / RATIO[1] - 1) < 0.01  # of an arm as its file says, though its masses are free
    assert float(sigma) / 100 < ESTIMATE


def test_stated_torque_constants_are_not_estimated_again(
    tmp_path: Path, arm: NominalDynamics, motion: stranger.Motion
) -> None:
    file = log(tmp_path / "x.csv", motion, "q{}", "current_{}_A", motion.torque / CONSTANT)
    text = look(file, nominal=replace(arm, stated_constant=CONSTANT)).text
    assert "as estimated" not in text
    assert "contradicts" not in text
    text = look(file, nominal=replace(arm, stated_constant=CONSTANT * [1, 2, 1])).text
    assert "torque_constant_nm_per_a of the figures is used, but this log contradicts it: j2 28 stated, 1" in text


@pytest.mark.parametrize("is_current", [False, True])
def test_readings_without_a_name_are_what_the_figures_fit(
    tmp_path: Path, arm: NominalDynamics, motion: stranger.Motion, is_current: bool
) -> None:
    stated = replace(arm, gear_ratio=RATIO, stated_constant=CONSTANT)
    file = log(tmp_path / "x.csv", motion, "q{}", "load{}", motion.torque / (CONSTANT if is_current else RATIO))
    form = proposed(tmp_path, look(file, nominal=stated).text)
    if is_current:
        assert [form.columns[f"current_{j}_a"].factor for j in JOINTS] == [1] * 3
    else:
        assert [form.columns[f"tau_motor_{j}_nm"].factor for j in JOINTS] == [50, 121, 200]


@pytest.mark.parametrize("name", ["m{}_pos_rad", "pos_m{}_rad", "M{}_angle_rad", "m{}_pos", "moment{}_deg"])
def test_angles_of_motors_are_no_torques(name: str) -> None:
    """The m of the motor was that of a moment."""
    (family,) = families_by_name([name.format(j) for j in JOINTS], ())
    assert family.kind == "position"


@pytest.mark.parametrize(("name", "kind"), [("M{}", "torque"), ("Achse{}_M_Nm", "torque"), ("m{}_current", "current")])
def test_the_m_of_a_moment_is_still_one(name: str, kind: str) -> None:
    (family,) = families_by_name([name.format(j) for j in JOINTS], ())
    assert family.kind == kind


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("JT{}_SPD[deg/s]", "velocity"),
        ("Achse {} [Grad/s]", "velocity"),
        ("axis_{}_rad_per_s", "velocity"),
        ("drive{}.rpm", "velocity"),
        ("joint{} [deg/s^2]", "acceleration"),
        ("Nm{}[Nm/s]", "unknown"),
    ],
)
def test_an_angle_by_time_is_a_rate(name: str, kind: str) -> None:
    """Speeds in deg/s were held against the masses as torques, or were the angles of joints."""
    (family,) = families_by_name([name.format(j) for j in JOINTS], ())
    assert (family.kind, family.numbers) == (kind, JOINTS)


def test_what_a_log_does_not_tell_is_not_proposed(
    tmp_path: Path, arm: NominalDynamics, motion: stranger.Motion
) -> None:
    """Factors of 4 +- 3051637300340 % stood there, with 120 kg of payload and a gain_sigma of 0.01."""
    friction = 40 * np.tanh(motion.velocity / 0.01) + np.random.default_rng(3).normal(size=motion.velocity.shape)
    file = log(tmp_path / "x.csv", motion, "q{}", "load{}", friction)
    text = look(file, nominal=arm).text
    assert "this log tells no factor of load1 to load3" in text
    assert "kg of payload" not in text
    assert "gain_sigma" not in text
    untold = [line for line in text.splitlines() if "this log does not tell the factor" in line]
    assert untold
    assert all(line.startswith("  # tau_motor_") and ", factor:" not in line for line in untold)
    assert not any(name.startswith("tau_motor_") for name in proposed(tmp_path, text).columns)


def test_motions_without_a_torque_are_warned_of(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "arm.xml").write_text(stranger.mjcf())
    assert main(["new-robot", "arm", "--mjcf", str(tmp_path / "arm.xml"), "-o", str(tmp_path / "arm")]) == 0
    rows = "".join(f"{k / 50},{0.1 * np.sin(k / 50):.6f},0.2,{0.1 * np.cos(k / 50):.6f}\n" for k in range(200))
    (tmp_path / "x.csv").write_text("t,q1,q2,q3\n" + rows)
    columns = "".join(f"  q_motor_{j}_rad: {{from: q{j}}}\n" for j in JOINTS)
    (tmp_path / "log.yaml").write_text("columns:\n  time_s: {from: t}\n" + columns)
    capsys.readouterr()
    words = ["convert", str(tmp_path / "arm"), str(tmp_path / "x.csv"), "--log", str(tmp_path / "log.yaml")]
    assert main([*words, "-o", str(tmp_path / "campaign")]) == 0
    said = capsys.readouterr().out
    assert "log.yaml reads neither torques nor currents of the drives" in said
    assert "1 warning" in said


def test_a_letter_stands_for_the_one_drive_that_has_no_number() -> None:
    """As SCARAs have it; the currents of such a log were taken for torques behind unknown gears."""
    names = ["A1_Strom [A]", "A2_Strom [A]", "Z_Strom [A]", "A4_Strom [A]", "Temperatur"]
    (family,) = families_by_name(names, ("shoulder", "elbow", "lift", "roll"))
    assert (family.kind, family.sources, family.numbers) == ("current", tuple(names[:4]), (1, 2, 3, 4))
    (others,) = families_by_name([*names, "U_Strom [A]"], ("shoulder", "elbow", "lift", "roll"))
    assert others.numbers == (1, 2, 4)


def test_the_unit_of_a_slide_is_its_own() -> None:
    """A controller of a SCARA writes its quill in mm; of three hinges and a quill neither made a family."""
    units = ["Grad", "Grad", "mm", "Grad"]
    names = [f"{what}_A{j}_{unit}" for j, unit in enumerate(units, 1) for what in ("Soll", "Ist")]
    command, measured = families_by_name([*names, "M_A1_N", "M_A1_Nm"], ("A1", "A2", "A3", "A4"))[:2]
    assert (command.kind, command.is_command, command.sources) == ("position", True, tuple(names[::2]))
    assert (measured.kind, measured.is_command, measured.sources) == ("position", False, tuple(names[1::2]))
    assert command.numbers == measured.numbers == (1, 2, 3, 4)


def test_a_family_has_each_drive_once() -> None:
    both = families_by_name(["q1_deg", "q2_deg", "q1_rad", "q2_rad"], ())
    assert [family.sources for family in both] == [("q1_deg", "q2_deg"), ("q1_rad", "q2_rad")]


def test_a_joint_called_x_is_not_looked_for_within_words() -> None:
    """The x of "Axis" was the joint, so X and Z were two families of one drive each."""
    names = [f"Axis_{joint}.{what}" for joint in "XZ" for what in ("SetPos [mm]", "ActVelo [mm/s]", "ActPos [mm]")]
    found = families_by_name(names, ("X", "Z"))
    assert [(f.kind, f.is_command, f.numbers) for f in found] == [
        ("position", True, (1, 2)),
        ("velocity", False, (1, 2)),
        ("position", False, (1, 2)),
    ]


def test_a_name_of_100_kb_takes_no_longer_than_others() -> None:
    """It was searched for a unit by time from each of its letters: a minute."""
    long = f"{'q' * 100_000}1 [deg/s]"
    assert rate_of(long) == rate_of("q1 [deg/s]") == "velocity"
    assert rate_of("degrees_per_sec**2") == "acceleration"
