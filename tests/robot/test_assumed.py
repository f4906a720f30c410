"""A started robot says what it assumed; nothing that matters is a default without a word."""

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yaml

from bench.cli import main
from bench.errors import RobotError
from bench.record.campaign import Campaign, Run
from bench.record.write import write_campaign
from bench.robot.compiled import compile_robot
from bench.robot.figures import Figures, Uncertainty
from bench.robot.folder import load_robot
from bench.robot.instrument_table import table
from bench.robot.instruments import Encoder, TorqueSensor, Tracker
from bench.robot.starter.defaults import ROTOR_GUESSED, SPIN_UP, WEAKEST
from bench.robot.starter.folder import Started, start_robot
from bench.robot.starter.source import read_source
from tests import stranger
from tests.stranger_started import MISSING, but_one_rotor

MODELS = Path(__file__).parents[2] / "models" / "README.md"


def started(tmp_path: Path, text: str, name: str = "arm.xml") -> Started:
    tmp_path.mkdir(exist_ok=True)
    (tmp_path / name).write_text(text)
    return start_robot("arm", read_source(tmp_path / name), tmp_path / "arm")


def figures_of(folder: Path) -> dict[str, object]:
    return dict(yaml.safe_load((folder / "figures.yaml").read_text()))


def test_damping_of_a_servo_is_no_friction(tmp_path: Path) -> None:
    """It was taken as viscous friction: 700 Nm at full speed, on drives of 80 to 250 Nm."""
    robot = started(tmp_path, stranger.mjcf("350"))
    np.testing.assert_array_equal([drive.viscous for drive in robot.drives], 0)
    readme = (tmp_path / "arm" / "README.md").read_text()
    assert (
        "damping 350 of the file would take more than half of the torque limit at full speed, so it is a servo's"
        in readme
    )


@pytest.mark.parametrize(
    ("damping", "servo", "kept"),
    [
        ("4", "0 -5000 -400", True),  # a servo with damping of its own beside ordinary friction
        ("4", "0 -5000 0", True),  # far too little to damp such a servo
        ("30", "0 -5000 0", False),  # at full speed 60 of 80 Nm or more; of drive 2 60 of 250 Nm, a fifth of critical
        ("30", "0 0 0", True),  # a motor, no servo; small enough for the strong drives
    ],
)
def test_damping_beside_other_actuators(tmp_path: Path, damping: str, servo: str, kept: bool) -> None:
    text = stranger.mjcf(damping).replace("0 -5000 0", servo)
    assert (started(tmp_path, text).drives[1].viscous > 0) == kept


def test_a_file_without_actuators_says_that_torque_limits_are_made_up(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A wrist of 0.2 g m^2 that gravity does not turn was given 0.0025 Nm."""
    wrist = (
        '<body pos="0.3 0 0" name="w"><inertial mass="0.2" pos="0 0 0" diaginertia="2e-4 2e-4 2e-4"/>'
        '<joint name="j4" axis="1 0 0" range="-3 3"/><geom size="0.02" mass="0"/></body>'
    )
    text = stranger.mjcf("0", actuators=False).replace("<site", wrist + "<site")
    (tmp_path / "arm.xml").write_text(text)
    assert main(["new-robot", "arm", "--mjcf", str(tmp_path / "arm.xml"), "-o", str(tmp_path / "arm")]) == 0
    said = capsys.readouterr().out
    assert re.search(r"assumed torque limit \(j1 .*j4 .*\) in Nm: the file limits no torque", said)
    assert "assumed speed limit (j1 3.142, j2 3.142, j3 3.142, j4 3.142) in rad/s: the file has none" in said
    assert "the file limits no torque" in (tmp_path / "arm" / "README.md").read_text()
    compiled = compile_robot(load_robot(tmp_path / "arm"))
    limits = compiled.model.actuator_forcerange[compiled.at.servo, 1]
    assert limits.min() >= 0.99 * WEAKEST * limits.max()
    assert limits.min() > 3


def test_what_is_assumed_stands_in_readme_figures_and_the_first_lines_of_check(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = started(tmp_path, stranger.mjcf())
    lines = robot.compiled.robot.figures.assumed
    readme = (tmp_path / "arm" / "README.md").read_text()
    assert all(f"- {line}\n" in readme for line in lines)
    words = " ".join(lines)
    for what in ("viscous friction", "Coulomb friction", "stiffness", "speed limit", "payload", "instruments"):
        assert what in words
    assert not any(line.startswith("torque limit") for line in lines)  # the file has it
    time = np.arange(400) / 100
    columns = {"time_s": time} | {f"q_motor_{j}_rad": np.sin(time + j) for j in (1, 2, 3)}
    write_campaign(Campaign(str(tmp_path / "arm"), (Run("a", "motion", 0.0, columns),)), tmp_path / "campaign")
    capsys.readouterr()
    main(["check", str(tmp_path / "campaign")])
    told = capsys.readouterr().out.splitlines()
    assert told[: len(lines)] == [f"assumed {line}" for line in lines]


def test_a_line_that_is_taken_out_is_gone(tmp_path: Path) -> None:
    started(tmp_path, stranger.mjcf())
    content = figures_of(tmp_path / "arm") | {"assumed": ["mass of the tool: by hand"]}
    (tmp_path / "arm" / "figures.yaml").write_text(yaml.safe_dump(content))
    assert load_robot(tmp_path / "arm").figures.assumed == ("mass of the tool: by hand",)


def test_payload_and_every_default_of_an_instrument_are_written_out(tmp_path: Path) -> None:
    started(tmp_path, stranger.mjcf())
    content = figures_of(tmp_path / "arm")
    assert content["uncertainty"]["payload_kg"] > 0  # type: ignore[index]
    figures = load_robot(tmp_path / "arm").figures
    for kind, part in (
        (Tracker, figures.instruments.tracker),
        (TorqueSensor, figures.instruments.torque),
        (Encoder, figures.instruments.encoder),
        (Uncertainty, figures.uncertainty),
    ):
        assert part is not None
        assert part.model_fields_set == set(kind.model_fields)


def test_missing_torque_constants_are_an_error_where_drives_report_current(tmp_path: Path) -> None:
    """They became 1 Nm/A without a word."""
    started(tmp_path, stranger.mjcf())
    content = figures_of(tmp_path / "arm")
    content["instruments"] |= {"current": {}, "torque": None}  # type: ignore[operator]
    (tmp_path / "arm" / "figures.yaml").write_text(yaml.safe_dump(content))
    with pytest.raises(RobotError, match=r"torque_constant_nm_per_a is missing for j1, j2, j3.*estimates it|tells it"):
        load_robot(tmp_path / "arm")


@pytest.mark.parametrize("command", [["check"], ["identify", "--method", "dynamics"]])
def test_missing_torque_constants_are_an_error_where_currents_are_logged(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: list[str]
) -> None:
    started(tmp_path, stranger.mjcf())
    time = np.arange(400) / 100
    columns = {"time_s": time} | {f"q_motor_{j}_rad": np.sin(time + j) for j in (1, 2, 3)}
    columns |= {f"current_{j}_a": np.cos(time + j) for j in (1, 2, 3)}
    write_campaign(Campaign(str(tmp_path / "arm"), (Run("a", "motion", 0.0, columns),)), tmp_path / "campaign")
    assert main([command[0], str(tmp_path / "campaign"), *command[1:]]) == 3
    said = "".join(capsys.readouterr())
    assert said.count("torque_constant_nm_per_a") == 1
    assert "current_1_a, current_2_a, current_3_a" in said


def test_the_speed_limit_stands_once(tmp_path: Path) -> None:
    started(tmp_path, stranger.mjcf())
    assert "velrange" not in (tmp_path / "arm" / "arm.xml").read_text()
    figures = tmp_path / "arm" / "figures.yaml"
    figures.write_text(figures.read_text().replace("speed_limit_rad_per_s: 3.142 ", "speed_limit_rad_per_s: 4 "))
    assert [d.speed_limit_rad_per_s for d in compile_robot(load_robot(tmp_path / "arm")).robot.figures.drives] == [
        4
    ] * 3
    file = tmp_path / "arm" / "arm.xml"
    file.write_text(file.read_text().replace('input="pos vel"', 'input="pos vel" velrange="-2 2"'))
    with pytest.raises(RobotError, match=r"drives\[0\].speed_limit_rad_per_s: is 4, but velrange of .* lets 2 through"):
        compile_robot(load_robot(tmp_path / "arm"))


def test_a_range_that_was_assumed_is_told(tmp_path: Path) -> None:
    text = stranger.mjcf().replace('axis="0 1 0" range="-2.6 2.6"', 'axis="0 1 0"', 1)
    text = text.replace(' ctrlrange="-2.6 2.6"', "")
    started(tmp_path, text)
    assert "range (j2 -360 to 360 degrees): the file has none" in load_robot(tmp_path / "arm").figures.assumed


def test_limits_and_shapes_of_a_urdf_are_kept(tmp_path: Path) -> None:
    """Speed limits and visual shapes were lost while the README said that nothing was left out."""
    (tmp_path / "pack" / "meshes").mkdir(parents=True)
    (tmp_path / "pack" / "urdf").mkdir()
    tetrahedron = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    (tmp_path / "pack" / "meshes" / "upper.obj").write_text(tetrahedron)
    robot = started(tmp_path, stranger.urdf("package://pack/meshes/upper.obj"), "pack/urdf/other.urdf")
    assert [drive.speed_limit for drive in robot.drives] == [1.7, 3.1]
    assert [drive.torque_limit for drive in robot.drives] == [120, 40]
    model = robot.compiled.model
    kinds = {int(kind) for kind in model.geom_type}
    assert {int(mujoco.mjtGeom.mjGEOM_MESH), int(mujoco.mjtGeom.mjGEOM_BOX), int(mujoco.mjtGeom.mjGEOM_SPHERE)} <= kinds
    assert (tmp_path / "arm" / "assets" / "upper.obj").is_file()
    assert "Left out: nothing." in (tmp_path / "arm" / "README.md").read_text()
    np.testing.assert_allclose(model.body("fore").mass, 2)


@pytest.mark.parametrize("mesh", ["package://gone/upper.stl", "meshes/upper.dae"])
def test_shapes_that_cannot_be_read_are_said_to_be_left_out(tmp_path: Path, mesh: str) -> None:
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "upper.dae").write_text("<COLLADA/>")
    started(tmp_path, stranger.urdf(mesh), "other.urdf")
    assert f"Left out: 1 shapes: {Path(mesh).name} of upper (" in (tmp_path / "arm" / "README.md").read_text()


def test_what_has_no_place_here_is_said_to_be_left_out(tmp_path: Path) -> None:
    text = (
        stranger.urdf().replace('effort="40"', 'effort="40.0"').replace("</robot>", '<transmission name="t"/></robot>')
    )
    text = text.replace("<dynamics", '<safety_controller k_velocity="1"/><dynamics')
    started(tmp_path, text, "other.urdf")
    assert "Left out: 1 safety_controller, 1 transmission." in (tmp_path / "arm" / "README.md").read_text()


@pytest.mark.parametrize(
    "spring", ['stiffness="40"', 'stiffness="40" springref="1.1"', 'springref="1.1"', 'springdamper="0.2 1"']
)
def test_a_spring_at_a_joint_is_said_to_be_left_out(tmp_path: Path, spring: str) -> None:
    """One that rests elsewhere than at zero was refused, as an elastic element that is wound; `springdamper` stayed."""
    started(tmp_path, stranger.mjcf().replace('name="j2" ', f'name="j2" {spring} '))
    said = "the spring of joint j2" in (tmp_path / "arm" / "README.md").read_text()
    assert said == (spring != 'springref="1.1"')
    model = compile_robot(load_robot(tmp_path / "arm")).model
    assert model.jnt_stiffness[model.joint("j2").id] == 0


def test_meshes_of_one_name_stay_two(tmp_path: Path) -> None:
    for folder, size in (("a", 0.1), ("b", 0.2)):
        (tmp_path / folder).mkdir()
        shape = f"v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nv 0 0 {size}\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
        (tmp_path / folder / "m.obj").write_text(shape)
    text = stranger.urdf("a/m.obj").replace('<sphere radius="0.05"/>', '<mesh filename="b/m.obj"/>')
    started(tmp_path, text, "other.urdf")
    texts = {file.read_text() for file in (tmp_path / "arm" / "assets").iterdir()}
    assert len(texts) == 2


def test_a_mass_that_the_file_does_not_give_is_said(tmp_path: Path) -> None:
    text = stranger.mjcf().replace('<inertial mass="3.0" pos="0.12 0 0" diaginertia="0.01 0.03 0.03"/>', "")
    text = text.replace('<geom size="0.05" mass="0"/><site', '<geom size="0.05"/><site')
    assert "mass of l3: the file gives shapes alone" in " ".join(started(tmp_path, text).compiled.robot.figures.assumed)


def test_the_world_has_no_mass_to_assume(tmp_path: Path) -> None:
    text = stranger.mjcf().replace("<worldbody>", '<worldbody><geom type="plane" size="1 1 1"/><geom size="0.1"/>')
    assert not any(line.startswith("mass of") for line in started(tmp_path, text).compiled.robot.figures.assumed)


def test_how_well_rotors_of_the_file_are_known_is_said(tmp_path: Path) -> None:
    """They were taken as known to a tenth without a word."""
    said = "uncertainty of rotor inertias: those of the file are taken as known to 10 %"
    assert said in started(tmp_path / "stated", stranger.mjcf()).compiled.robot.figures.assumed
    guessed = started(tmp_path / "guessed", stranger.mjcf(armature=5.0)).compiled.robot.figures
    assert guessed.uncertainty.rotor_inertia == ROTOR_GUESSED
    assert said not in guessed.assumed


def test_of_rotors_the_guessed_ones_alone_are_guesses(tmp_path: Path) -> None:
    """For one rotor that the file leaves out, all six of an arm counted as three times as large as anybody likes."""
    figures = started(tmp_path, but_one_rotor()).compiled.robot.figures
    known = [0.1, 0.1, 0.1]
    known[MISSING] = ROTOR_GUESSED
    assert figures_of(tmp_path / "arm")["uncertainty"]["rotor_inertia"] == known  # type: ignore[index]
    np.testing.assert_array_equal(figures.drive_uncertainty.rotor_inertia, known)
    (said,) = (line for line in figures.assumed if line.startswith("uncertainty of rotor inertias"))
    assert "those of the file (j1, j3) are taken as known to 10 %, guesses (j2) to 3 times the guess" in said
    assert f"- {said}\n" in (tmp_path / "arm" / "README.md").read_text()


def test_a_placeholder_for_some_drives_is_one(tmp_path: Path) -> None:
    """Beside a drive without any, one armature for 200 Nm and for 80 Nm was taken for both rotors, known to 10 %."""
    text = re.sub(r'armature="[^"]*"', 'armature="0.1"', but_one_rotor())
    robot = started(tmp_path, text)
    np.testing.assert_allclose([drive.rotor_inertia for drive in robot.drives], np.array(stranger.LIMIT) / SPIN_UP)
    figures = robot.compiled.robot.figures
    assert figures.uncertainty.rotor_inertia == ROTOR_GUESSED
    assert any("(j1 4, j3 1.6)" in line and "armature 0.1 of the file stands there" in line for line in figures.assumed)


def test_defaults_of_instruments_stand_in_one_table() -> None:
    """The README said 0.02 of a torque constant, the source 0.01."""
    text = MODELS.read_text(encoding="utf-8")
    assert table() in text
    assert "0.02 unless given" not in text
    assert Figures.model_fields["assumed"].description
