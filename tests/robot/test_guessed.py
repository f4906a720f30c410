"""What a started robot is guessed to be where its file says nothing: guesses hold for real arms, and doubt no data."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from bench.diagnose.plausibility.channels import BEYOND as SPEED_BEYOND
from bench.diagnose.plausibility.channels import doubts_of
from bench.diagnose.plausibility.single_rows import beyond_guessed_limits
from bench.effects.catalogue import catalogue
from bench.effects.masses import RotorInertia
from bench.effects.places import GUESSED, most_torque
from bench.record.campaign import Campaign, Run
from bench.record.read import read_campaign
from bench.record.write import write_campaign
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.starter.defaults import PRESLIDING, TWIST
from tests import stranger
from tests.robot.test_assumed import MODELS, figures_of, started

NINETY = 1.645  # standard deviations to either side that hold 90 %


@pytest.mark.parametrize(("effort", "is_placeholder"), [(10000.0, True), (200.0, False)])
def test_one_effort_for_weak_and_strong_drives_is_a_placeholder(
    tmp_path: Path, effort: float, is_placeholder: bool
) -> None:
    """As in many a URDF, effort 1000 at each joint: rotors of 20 kg m^2 and noise of 2 Nm were taken for a wrist."""
    text = re.sub(r'effort="[^"]*"', f'effort="{effort}"', stranger.urdf())
    robot = started(tmp_path, text, "arm.urdf")
    limits = np.array([drive.torque_limit for drive in robot.drives])
    assert (limits.max() < effort / 3) == is_placeholder
    assert bool(np.all(limits == effort)) != is_placeholder
    said = [line for line in robot.compiled.robot.figures.assumed if line.startswith("torque limit")]
    assert len(said) == int(is_placeholder)
    assert all("10000 of the file stands there for weak and strong drives alike" in line for line in said)


@pytest.mark.parametrize(("damping", "is_placeholder"), [(1.0, True), (0.2, False)])
def test_one_damping_for_weak_and_strong_drives_is_a_placeholder(
    tmp_path: Path, damping: float, *, is_placeholder: bool
) -> None:
    """Menagerie's Panda has damping 1 at each joint: three times what rubs in its wrist, taken as known to 20 %."""
    links = "".join(
        f'<body pos="0 0 0.2"><inertial mass="2" pos="0.1 0 0.1" diaginertia="0.1 0.1 0.1"/>'
        f'<joint name="j{j}" axis="0 1 0" range="-2 2" damping="{damping if j else 1.0}"/>'
        for j in range(3)
    )
    motors = "".join(f'<motor joint="j{j}" ctrlrange="-{t} {t}"/>' for j, t in enumerate((87, 87, 12)))
    text = f'<mujoco><compiler angle="radian"/><worldbody>{links}<site name="tool"/>{"</body>" * 3}</worldbody>'
    robot = started(tmp_path, f"{text}<actuator>{motors}</actuator></mujoco>")
    assert [drive.viscous for drive in robot.drives] == ([0.0] * 3 if is_placeholder else [1.0, 0.2, 0.2])
    said = [line for line in robot.compiled.robot.figures.assumed if line.startswith("viscous friction")]
    assert ["damping 1 of the file stands there for weak and strong drives alike" in line for line in said] == (
        [True] if is_placeholder else []
    )


@pytest.mark.parametrize(
    ("arm", "torque", "reach", "rated"),
    [("UR5e", 150, 0.85, 5.0), ("UR10e", 330, 1.3, 12.5), ("Panda", 87, 0.855, 3.0), ("iiwa 14", 320, 0.82, 14.0)],
)
def test_a_payload_may_be_what_the_arm_carries(
    tmp_path: Path, arm: str, torque: float, reach: float, rated: float
) -> None:
    """Data sheets; on a pedestal. A fifth of the strongest drive's torque was less than each of these arms carries."""
    text = (
        f'<mujoco><worldbody><body pos="0 0 2"><inertial mass="10" pos="0 0 {reach / 3}" diaginertia="1 1 0.1"/>'
        f'<joint name="j" axis="0 1 0" range="-2 2"/><site name="tool" pos="0 0 {reach}"/></body></worldbody>'
        f'<actuator><motor joint="j" ctrlrange="-{torque} {torque}"/></actuator></mujoco>'
    )
    started(tmp_path, text)
    uncertainty = figures_of(tmp_path / "arm")["uncertainty"]
    assert isinstance(uncertainty, dict)
    assert 1.5 * rated < uncertainty["payload_kg"] < 5 * rated


def test_limits_that_were_made_up_are_known_as_such(tmp_path: Path) -> None:
    figures = started(tmp_path, stranger.mjcf("0", actuators=False)).compiled.robot.figures
    for joint in ("j1", "j2", "j3"):
        assert figures.assumes("speed limit", joint)
        assert figures.assumes("torque limit", joint)
    assert not figures.assumes("speed limit", "j")
    with_actuators = started(tmp_path / "other", stranger.mjcf()).compiled.robot.figures
    assert not with_actuators.assumes("torque limit", "j1")


def test_data_beyond_a_limit_that_was_made_up_are_not_doubted(tmp_path: Path) -> None:
    """A wrist at 9 rad/s on a file that says nothing of speed was "degrees or millimetres?"."""
    (tmp_path / "arm.xml").write_text(stranger.mjcf())
    main(["new-robot", "arm", "--mjcf", str(tmp_path / "arm.xml"), "-o", str(tmp_path / "arm")])
    motion = stranger.moved(np.random.default_rng(1), 10.0)
    quick = 1.1 * SPEED_BEYOND * 3.142 / np.max(np.abs(motion.velocity))
    columns = {"time_s": motion.time / quick}
    columns |= {f"q_motor_{j + 1}_rad": motion.position[:, j] for j in range(3)}
    columns |= {f"tau_motor_{j + 1}_nm": motion.torque[:, j] for j in range(3)}
    write_campaign(Campaign(str(tmp_path / "arm"), (Run("a", "motion", 0.0, columns),)), tmp_path / "campaign")
    compiled = compile_robot(load_robot(tmp_path / "arm"))
    campaign = read_campaign(tmp_path / "campaign")
    assert not [found for found in doubts_of(campaign, compiled) if "its limit is" in str(found)]
    figures = compiled.robot.figures.model_copy(update={"assumed": ()})
    stated = replace(compiled, robot=replace(compiled.robot, figures=figures))
    assert [found for found in doubts_of(campaign, stated) if "its limit is" in str(found)]


def test_another_unit_is_doubted_all_the_same(tmp_path: Path) -> None:
    """Torques in mNm passed as Nm on a file that limits no torque."""
    (tmp_path / "arm.xml").write_text(stranger.mjcf("0", actuators=False))
    main(["new-robot", "arm", "--mjcf", str(tmp_path / "arm.xml"), "-o", str(tmp_path / "arm")])
    motion = stranger.moved(np.random.default_rng(1), 10.0)
    columns = {"time_s": motion.time}
    columns |= {f"q_motor_{j + 1}_rad": motion.position[:, j] for j in range(3)}
    compiled = compile_robot(load_robot(tmp_path / "arm"))
    for unit in (1.0, 1000.0):
        torques = {f"tau_motor_{j + 1}_nm": unit * motion.torque[:, j] for j in range(3)}
        folder = tmp_path / f"campaign-{unit:g}"
        write_campaign(Campaign(str(tmp_path / "arm"), (Run("a", "motion", 0.0, columns | torques),)), folder)
        found = [str(doubt) for doubt in doubts_of(read_campaign(folder), compiled)]
        assert len(found) == (0 if unit == 1 else 3)
        assert all("mNm" in one for one in found)


def test_stiffness_is_guessed_as_well_as_is_said(tmp_path: Path) -> None:
    """The measured joints of the HH-150. They were guessed 2.5 to 10 times too stiff, and said to be known to 50 %."""
    robot = started(tmp_path, stranger.mjcf())
    known_to = 1 + robot.compiled.robot.figures.uncertainty.stiffness
    measured = compile_robot(load_robot(MODELS.parent / "hh150"))
    limits = measured.model.actuator_forcerange[measured.at.servo, 1]
    assert np.all(np.abs(np.log(limits / TWIST / measured.stiffness)) < NINETY * np.log(known_to))
    assert np.mean(np.abs(np.log(limits / TWIST / measured.stiffness)) < np.log(known_to)) > 0.5
    assert f"winds it up by {TWIST * 1e3:g} mrad" in " ".join(robot.compiled.robot.figures.assumed)


def test_a_guessed_rotor_may_be_hardly_there() -> None:
    """Joint torque sensors sit behind it. With 5 % of the guess at least, 0.4 Nm stayed that nobody measured."""
    robot = compile_robot(load_robot(MODELS.parent / "hh150"))
    effect = RotorInertia()
    (change,) = effect.parameters_at(robot, effect.places(robot)[0])
    assert change.least is not None
    assert 0 < 1 + change.least < 0.01


def test_friction_that_is_found_later_builds_up_as_fast_as_real_friction(tmp_path: Path) -> None:
    """A slide's friction of 4.5 % of its limit built up over 0.45 mm; half of it was found on the link side for it."""
    for drive in started(tmp_path, stranger.mjcf("0")).drives:
        assert drive.coulomb == 0
        assert 0.045 * drive.torque_limit / drive.motor_presliding < 1.1 * PRESLIDING


def test_friction_may_be_more_where_the_speed_limit_was_made_up(tmp_path: Path) -> None:
    """At 180 deg/s a wrist would have had no torque left; it never went that fast, and its friction was refused."""
    guessed = started(tmp_path, stranger.mjcf()).compiled
    figures = guessed.robot.figures
    assert figures.assumes("speed limit", "j1")
    stated = replace(guessed, robot=replace(guessed.robot, figures=figures.model_copy(update={"assumed": ()})))
    for name, factor in (("viscous_friction", GUESSED), ("coulomb_friction", 1.0)):
        effect = catalogue()[name]
        (most, least) = (effect.parameters_at(one, effect.places(one)[0])[0].high for one in (guessed, stated))
        assert most == pytest.approx(factor * least)


def test_a_servo_that_is_stronger_than_its_joint_needs_keeps_its_limit(tmp_path: Path) -> None:
    """Of a pan-tilt with two servos of 1.5 Nm the upright one was given 0.019 Nm, and its friction was not seen."""
    inertia = 'ixx="3e-4" iyy="3e-4" izz="3e-4" ixy="0" ixz="0" iyz="0"'
    link = f'<inertial><origin xyz="0.01 0 0.02"/><mass value="0.3"/><inertia {inertia}/></inertial>'
    limit = '<limit lower="-1.5" upper="1.5" effort="1.5" velocity="5"/>'
    text = (
        f'<robot name="pan_tilt"><link name="base">{link}</link><link name="yoke">{link}</link>'
        f'<link name="head">{link}</link>'
        f'<joint name="pan" type="revolute"><parent link="base"/><child link="yoke"/><axis xyz="0 0 1"/>{limit}</joint>'
        f'<joint name="tilt" type="revolute"><parent link="yoke"/><child link="head"/><origin xyz="0 0 0.08"/>'
        f'<axis xyz="0 1 0"/>{limit}</joint></robot>'
    )
    assert [drive.torque_limit for drive in started(tmp_path, text, "arm.urdf").drives] == [1.5, 1.5]


def test_torques_beyond_a_limit_that_was_made_up_are_a_warning(tmp_path: Path) -> None:
    """Seven times the limit was recorded, rotor, stiffness and payload were guessed by it, and nothing said so."""
    (tmp_path / "arm.xml").write_text(stranger.mjcf("0", actuators=False))
    main(["new-robot", "arm", "--mjcf", str(tmp_path / "arm.xml"), "-o", str(tmp_path / "arm")])
    compiled = compile_robot(load_robot(tmp_path / "arm"))
    motion = stranger.moved(np.random.default_rng(1), 10.0)
    largest = float(np.percentile(np.abs(motion.torque[:, 1]), 99))
    limit = most_torque(compiled, 1)
    for times in (0.9, 3.0):
        columns = {"time_s": motion.time, "tau_motor_2_nm": times * limit / largest * motion.torque[:, 1]}
        campaign = Campaign("arm", (Run("a", "motion", 0.0, columns),))
        found = list(beyond_guessed_limits(campaign, compiled))
        assert [one.column for one in found] == (["tau_motor_2_nm"] if times > 1 else [])
