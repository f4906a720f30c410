"""`bench new-robot`: somebody's MJCF or URDF becomes a robot folder that works, or the fault is named."""

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest

from bench.cli import main
from bench.errors import InputError, RobotError
from bench.identify.arm import Arm
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.links import rigid_bodies
from bench.robot.logs import log_format_of
from bench.robot.starter.defaults import ROTOR_GUESSED, SPIN_UP
from bench.robot.starter.folder import start_robot
from bench.robot.starter.source import read_source
from bench.simulate.env import BenchEnv
from bench.simulate.equilibrium import Equilibrium

AGREEMENT = 1e-9  # of masses and gravity torques with the file's own
FOLLOWS = 2e-3  # [rad], how near a started servo comes to its command within two seconds under a load


def works(folder: Path) -> None:
    """Let it rest, and move to a command under a load."""
    robot = load_robot(folder)
    compiled = compile_robot(robot)
    log_format_of(robot)
    Arm(rigid_bodies(compiled))
    home = compiled.model.key("home").ctrl[compiled.at.servo_ctrl]
    Equilibrium(compiled).solve(home, np.array([5.0, 3.0, -10.0, 0, 0, 0]))
    data = mujoco.MjData(compiled.model)
    mujoco.mj_resetDataKeyframe(compiled.model, data, compiled.model.key("home").id)
    start = data.qpos.copy()
    for _ in range(2000):
        mujoco.mj_step(compiled.model, data)
    np.testing.assert_allclose(data.qpos, start, rtol=0, atol=1e-8)

    env = BenchEnv(str(folder), truth=True)
    env.reset(seed=1, options={"q": home})
    rated = env.action_space["wrench"]
    goal, load = home + 0.05, np.clip([5.0, 3.0, -10.0, 0, 0, 0], rated.low, rated.high)
    for k in range(600):
        blend = min(k / 100, 1.0)
        observation, *_, info = env.step({"q_cmd": home + blend * (goal - home), "wrench": blend * load})
    assert env.observation_space.contains(observation)
    np.testing.assert_allclose(info["truth"].q[0], goal, rtol=0, atol=FOLLOWS)
    scene = mujoco.MjModel.from_xml_path(str(folder / "scene.xml"))
    assert scene.nv == 2 * compiled.n_joints
    assert (folder / "README.md").is_file()


def test_menagerie_arm(menagerie: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new-robot", "twig", "--mjcf", str(menagerie), "-o", str(tmp_path / "robot")]) == 0
    assert "3 drives: j1, j2, j3" in capsys.readouterr().out
    works(tmp_path / "robot")
    compiled = compile_robot(load_robot(tmp_path / "robot"))
    model, at = compiled.model, compiled.at
    np.testing.assert_allclose(model.dof_armature[at.q_dof], [0.1, 0.1, 0.05])
    np.testing.assert_allclose(model.dof_armature[at.theta_dof], 0)
    np.testing.assert_allclose(compiled.motor_coulomb, 2)
    np.testing.assert_allclose(compiled.link_coulomb, 0)
    np.testing.assert_allclose(model.actuator_forcerange[at.servo, 1], [150, 150, 30])
    np.testing.assert_allclose(compiled.limits, [[-2, 2]] * 3)
    np.testing.assert_allclose(model.key("home").ctrl[at.servo_ctrl], [0, 0.5, 0])
    assert np.all(model.geom_contype == 0)
    readme = (tmp_path / "robot" / "README.md").read_text()
    assert "joint finger1, held at its zero" in readme
    assert "site 'attachment_site' of the file" in readme


def test_an_arm_with_masses_in_its_shapes_alone(stick: Path, tmp_path: Path) -> None:
    """Before such a file is compiled, the centre of mass of its last link is no number."""
    source = read_source(stick)
    np.testing.assert_allclose(source.load_point.position, (0.35, 0, 0), atol=1e-9)
    robot = start_robot("stick", source, tmp_path / "stick").compiled.robot
    assert [drive.joint for drive in robot.figures.drives] == ["j1", "j2"]


def test_one_armature_for_weak_and_strong_drives_is_a_placeholder(menagerie: Path, tmp_path: Path) -> None:
    """As mujoco_menagerie has it of the UR10e and others: rotors of 0.1 kg m^2 behind 330 and 56 Nm."""
    text = (menagerie.parent / "defaults.xml").read_text()
    assert 'armature="0.05"' in text
    (menagerie.parent / "defaults.xml").write_text(text.replace('armature="0.05"', 'armature="0.1"'))
    robot = start_robot("twig", read_source(menagerie), tmp_path / "robot").compiled
    np.testing.assert_allclose(robot.model.dof_armature[robot.at.q_dof], np.array([150, 150, 30]) / SPIN_UP)
    assert robot.robot.figures.uncertainty.rotor_inertia == ROTOR_GUESSED
    assert any("armature 0.1 of the file stands there" in line for line in robot.robot.figures.assumed)


def test_a_name_that_means_something_in_yaml_is_a_name(stick: Path, tmp_path: Path) -> None:
    assert start_robot("off", read_source(stick), tmp_path / "off").compiled.robot.figures.title == "off"


def test_links_are_those_of_the_file(menagerie: Path, tmp_path: Path) -> None:
    original = mujoco.MjModel.from_xml_path(str(menagerie))
    data = mujoco.MjData(original)
    started = start_robot("twig", read_source(menagerie), tmp_path / "robot")
    arm = Arm(rigid_bodies(started.compiled))
    for q in ([0.1, 0.2, -0.3], [1.0, -0.8, 1.5]):
        data.qpos[:3] = q
        mujoco.mj_forward(original, data)
        np.testing.assert_allclose(arm.gravity(np.array([q]))[0], data.qfrc_bias[:3], atol=AGREEMENT)
        position, _ = arm.pose(np.array(q), "bench_load_point")
        np.testing.assert_allclose(position, data.site("attachment_site").xpos, atol=AGREEMENT)


def test_urdf_with_a_slide(urdf: Path, tmp_path: Path) -> None:
    started = start_robot("lift", read_source(urdf), tmp_path / "robot")
    works(tmp_path / "robot")
    assert started.compiled.is_slide == (True, False)
    assert started.source.load_point.body == "tool0"
    np.testing.assert_allclose(started.compiled.limits, [[-0.2, 1], [-2 * np.pi, 2 * np.pi]])
    assert started.drives[0].torque_limit == 500
    np.testing.assert_allclose(started.compiled.motor_coulomb, [0, 0.2])
    assert "tau_motor_1_n:" in (tmp_path / "robot" / "log.yaml").read_text()


def test_urdf_with_a_link_that_hangs_on_no_joint(urdf: Path) -> None:
    """As ROS has it, too; the link stood in the model, fixed to the world, and "left out: nothing" was said."""
    text = urdf.read_text()
    lost = text[: text.index('  <joint name="fixed"')] + "</robot>"
    urdf.write_text(lost)
    with pytest.raises(
        RobotError, match=r"lift\.urdf: links 'base' and 'tool0' hang on no joint, and only the base may"
    ):
        read_source(urdf)
    urdf.write_text(lost.replace("</robot>", "".join(f'<link name="l{i}"/>' for i in range(6)) + "</robot>"))
    with pytest.raises(RobotError, match="'base' and 'tool0' and 'l0' and 'l1' and 4 more hang on no joint"):
        read_source(urdf)


def test_named_joints_and_load_point(menagerie: Path, tmp_path: Path) -> None:
    source = read_source(menagerie, ["j2", "j3"], "attachment_site")
    assert [joint.name for joint in source.joints] == ["j2", "j3"]
    start_robot("part", source, tmp_path / "robot")
    works(tmp_path / "robot")


def test_load_point_and_reflectors_of_a_urdf_are_links(
    urdf: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A URDF has no sites: `--load-point hook` was refused, and the last link of the file taken, a reflector's nest."""
    extra = "".join(
        f'<link name="{name}"/><joint name="{name}_fixed" type="fixed"><parent link="b"/><child link="{name}"/>'
        f'<origin xyz="{place}"/></joint>'
        for name, place in (("hook", "0.5 0 -0.1"), ("nest_1", "0.4 0.1 0"), ("nest_2", "0.4 -0.1 0.1"))
    )
    urdf.write_text(urdf.read_text().replace("</robot>", extra + "</robot>"))
    command = ["new-robot", "lift", "--mjcf", str(urdf), "-o", str(tmp_path / "robot"), "--load-point"]
    assert main([*command, "hok"]) == RobotError.exit_code
    said = capsys.readouterr().err
    assert "unknown site or link (its frame) behind the last driven joint 'hok'. Did you mean 'hook'?" in said
    assert "Known: b, hook, nest_1, nest_2, tool0." in said
    assert main([*command, "hook", "--reflectors", "nest_1", "nest_1"]) == RobotError.exit_code
    assert "--reflectors: nest_1 nest_1 names one twice" in capsys.readouterr().err
    assert main([*command, "hook", "--reflectors", "nest_2", "nest_1"]) == 0
    said = capsys.readouterr().out
    assert "load point: frame of link 'hook' of the file" in said
    assert "reflector 2: frame of link 'nest_1' of the file" in said
    works(tmp_path / "robot")
    compiled = compile_robot(load_robot(tmp_path / "robot"))
    data, at = mujoco.MjData(compiled.model), compiled.at
    mujoco.mj_forward(compiled.model, data)
    sites = [at.load_point, *at.reflectors]
    np.testing.assert_allclose(data.site_xpos[sites], [[0.5, 0, 0.1], [0.4, -0.1, 0.3], [0.4, 0.1, 0.2]], atol=1e-9)


@pytest.mark.parametrize(
    ("spring", "said"),
    [
        ('<joint name="j1" stiffness="250"', r"gravity of j1 is no longer held by the spring of the joint"),
        ('<joint name="j1"', r"gravity of j1 is no longer held by tendon 'gas'.*: up to \d+ Nm .*`counterbalance`"),
    ],
)
def test_a_balance_that_is_left_out_is_said(
    stick: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], spring: str, said: str
) -> None:
    """Of 3 kNm of a gravity balance "left out: 1 tendons" was all that was said, not where to put it back."""
    text = stick.read_text().replace('<joint name="j1"', spring)
    if "stiffness" not in spring:
        text = text.replace("<worldbody>", '<worldbody><site name="a" pos="0 0 0.5"/>')
        text = text.replace('<body name="lower"', '<site name="b" pos="0 0 0.4"/><body name="lower"')
        spatial = '<spatial name="gas" stiffness="2000" springlength="0"><site site="a"/><site site="b"/></spatial>'
        text = text.replace("</mujoco>", f"<tendon>{spatial}</tendon></mujoco>")
    stick.write_text(text)
    assert main(["new-robot", "stick", "--mjcf", str(stick), "-o", str(tmp_path / "robot")]) == 0
    printed = capsys.readouterr().out
    assert re.search(said, printed)
    assert "gravity of j2" not in printed
    assert re.search(said, (tmp_path / "robot" / "README.md").read_text())


def test_the_benchs_own_robots_can_be_read() -> None:
    """Their actuators have several controls, which ended in a traceback.

    Their elastic elements pull as tendons do, with the rotors held thousands of times harder than the cylinder, so that
    nothing was said of the counterbalance.
    """
    joints = tuple(f"joint{j}" for j in range(1, 7))
    source = read_source(load_robot("hh150").mjcf, joints)
    assert tuple(joint.name for joint in source.joints) == joints
    (said,) = source.lost_balance
    assert re.match(r"gravity of joint2 is no longer held by tendon 'cbs'.*: up to 6\.15e\+03 Nm", said)


def test_a_spring_about_an_upright_axis_holds_no_gravity(menagerie: Path) -> None:
    menagerie.write_text(menagerie.read_text().replace('<joint name="j1"', '<joint name="j1" stiffness="30"'))
    source = read_source(menagerie)
    assert "the spring of joint j1" in source.left_out
    assert source.lost_balance == ()


@pytest.mark.parametrize(
    ("old", "new", "options", "said"),
    [
        ('mass="3"', 'mass="-3"', [], r"twig\.xml: .*'l2'.*; give the body positive mass"),
        ('<inertial mass="4" pos="0 0 0.1" diaginertia="0.02 0.02 0.02"/>', "", [], None),  # the geom gives it
        ('file="tri.obj"', 'name="tri" file="none.obj"', [], r"none\.obj.*; put the file where the MJCF says"),
        (
            'file="tri.obj"',
            'name="tri" file="none.obj"',
            [],
            r"geoms of type mesh, .* may be deleted where bodies have",
        ),
        ('<body name="base" childclass="arm">', '<body name="base" childclass="arm"><freejoint/>', [], r"fix the base"),
        ('name="j2"/>', 'name="j2" type="ball" range="0 1"/>', [], r"ball joint; write it as three hinges"),
        ('name="j2"/>', 'name="j2"/><joint name="k" axis="1 0 0"/>', [], r"body 'l2' has several joints"),
        ('name="j2"/>', 'name="j2" ref="0.3"/>', [], r"joint 'j2' has ref != 0; move its zero"),
        ("", "", ["--joints", "j1", "jx"], r"--joints: unknown joint 'jx'.*Known: finger1"),
        ("", "", ["--joints", "finger1", "finger2"], r"'finger2' does not hang on 'finger1'"),
        ("", "", ["--joints", "j2", "j1"], r"'j1' does not hang on 'j2'.*from the base to the tool"),
        ("", "", ["--load-point", "hook"], r"unknown site or link .*'hook'.*attachment_site"),
        ("<worldbody>", '<worldbody><body><joint name="door"/><geom size="1"/></body>', [], r"several arms.*--joints"),
    ],
)
def test_faults_are_named_and_nothing_is_left(
    menagerie: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    old: str,
    new: str,
    options: list[str],
    said: str | None,
) -> None:
    text = menagerie.read_text()
    assert old in text
    text = text.replace(old, new, 1)
    if "freejoint" in new or 'type="ball"' in new or "<joint name=" in new:
        text = text[: text.index("<keyframe>")] + "</mujoco>"  # its length no longer fits
    menagerie.write_text(text)
    code = main(["new-robot", "twig", "--mjcf", str(menagerie), "-o", str(tmp_path / "robot"), *options])
    if said is None:
        assert code == 0
        return
    assert code == RobotError.exit_code
    assert re.search(said, capsys.readouterr().err)
    assert [path.name for path in tmp_path.iterdir()] == ["twig_arm"]


def test_bad_name_and_missing_file(urdf: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="use letters"):
        start_robot("my arm/", read_source(urdf), tmp_path / "robot")
    with pytest.raises(RobotError, match="no such file"):
        read_source(tmp_path / "nothing.xml")
    with pytest.raises(RobotError, match="is a folder; give the MJCF"):
        read_source(tmp_path)
    with pytest.raises(RobotError, match="/dev/zero: is a device"):
        read_source(Path("/dev/zero"))


def test_robots_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["robots"]) == 0
    said = capsys.readouterr().out
    for name in ("emps", "hh150", "kr300"):
        assert f"{name}: " in said
