"""The URDF is the robot: held against MuJoCo, and against the arm that the bench itself uses, in Pinocchio."""

from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pytest

from bench.identify.arm import Arm
from bench.report.handover.applied import Applied, applied_robot
from bench.report.handover.robot_folder import hand_over
from bench.report.handover.urdf import urdf_of
from bench.report.handover.urdf_gaps import gaps_of
from bench.robot.compiled import compile_robot, read_spec
from bench.robot.folder import load_robot
from bench.robot.plugins import configure
from bench.robot.write import write_robot
from tests.report.handover.made import CASES, design_for, fit_of
from tests.small_robot import write_small_robot

ROUNDING = 1e-9  # of the largest number: of angles that go through roll, pitch, yaw, and of quaternions made of them
STATES = 5


def model_of(applied: Applied) -> pinocchio.Model:
    return pinocchio.buildModelFromXML(urdf_of(applied, "robot"))


@pytest.fixture(scope="module", params=["hh150", "kr300", "emps", "found", "tilted"])
def applied(request: pytest.FixtureRequest, found: Path, tmp_path_factory: pytest.TempPathFactory) -> Applied:
    if request.param == "found":
        return applied_robot(load_robot(found / "robot"), 3.0)
    if request.param == "tilted":  # a link that points straight up and down, where roll and yaw are one
        robot = write_small_robot(tmp_path_factory.mktemp("robots") / "small")
        text = (
            (robot / "small.xml")
            .read_text()
            .replace('<body name="fore"', '<body name="fore" euler="0.3 1.5707963267948966 0.2"')
        )
        (robot / "small.xml").write_text(text)
        return applied_robot(load_robot(robot))
    return applied_robot(load_robot(request.param))


def test_pinocchio_reads_the_same_dynamics(applied: Applied, rng: np.random.Generator) -> None:
    model, arm = model_of(applied), Arm(applied.bodies)
    data = model.createData()
    assert list(model.names)[1:] == list(applied.bodies.names)
    for _ in range(STATES):
        q, velocity, acceleration = rng.uniform(-1, 1, (3, model.nv)) * [[1.0], [2.0], [3.0]]
        expected = arm.inverse_dynamics(q, velocity, acceleration)
        found = pinocchio.rnea(model, data, q, velocity, acceleration)
        np.testing.assert_allclose(found, expected, atol=ROUNDING * np.abs(expected).max())
        pinocchio.framesForwardKinematics(model, data, q)
        load = applied.compiled.robot.figures.load_point
        frame = data.oMf[max(i for i, one in enumerate(model.frames) if one.name.startswith(load))]
        position, rotation = arm.pose(q, load)
        np.testing.assert_allclose(frame.translation, position, atol=ROUNDING)
        np.testing.assert_allclose(frame.rotation, rotation, atol=ROUNDING)


def test_mujoco_has_the_same_dynamics(applied: Applied, rng: np.random.Generator) -> None:
    """Inverse dynamics of the MJCF's links, with its rotors at rest."""
    urdf, mjcf, at = model_of(applied), applied.compiled.model, applied.compiled.at
    data = mujoco.MjData(mjcf)
    for _ in range(STATES):
        q, velocity, acceleration = rng.uniform(-1, 1, (3, urdf.nv)) * [[1.0], [2.0], [3.0]]
        data.qpos[at.theta], data.qvel[at.theta_dof] = q, velocity
        data.qacc[at.theta_dof] = acceleration
        mujoco.mj_fwdPosition(mjcf, data)
        mujoco.mj_fwdVelocity(mjcf, data)
        expected = np.zeros(mjcf.nv)
        mujoco.mj_rne(mjcf, data, 1, expected)
        found = pinocchio.rnea(urdf, urdf.createData(), q, velocity, acceleration)
        np.testing.assert_allclose(found, expected[at.theta_dof], atol=ROUNDING * np.abs(found).max())


def test_limits_and_friction_are_those_of_the_drives(applied: Applied) -> None:
    model, compiled = model_of(applied), applied.compiled
    np.testing.assert_allclose(model.lowerPositionLimit, compiled.limits[:, 0])
    np.testing.assert_allclose(model.upperPositionLimit, compiled.limits[:, 1])
    np.testing.assert_allclose(model.effortLimit, compiled.model.actuator_forcerange[compiled.at.servo, 1])
    np.testing.assert_allclose(model.friction, compiled.motor_coulomb + compiled.link_coulomb)
    speeds = [drive.speed_limit_rad_per_s for drive in compiled.robot.figures.drives]
    np.testing.assert_allclose(model.velocityLimit, speeds)


def test_a_payload_hangs_at_the_load_point(small_robot: Path) -> None:
    robot = load_robot(small_robot)
    light, heavy = applied_robot(robot), applied_robot(robot, 3.0)
    assert heavy.bodies.mass.sum() - light.bodies.mass.sum() == pytest.approx(3.0)
    point = light.bodies.points[robot.figures.load_point]
    moment = heavy.bodies.mass[1] * heavy.bodies.com[1] - light.bodies.mass[1] * light.bodies.com[1]
    np.testing.assert_allclose(moment, 3.0 * point.position, atol=1e-12)


def test_what_is_left_out_is_said(small_robot: Path, tmp_path: Path) -> None:
    """Passive hinges are stiff, and the friction's laws, learned torques, readings as fitted are named."""
    robot = load_robot(small_robot)
    linear = design_for(compile_robot(robot))
    hand_over(
        linear, fit_of(linear, CASES["a joint more"], np.random.default_rng(7)), tmp_path / "a", tmp_path / "n.xml"
    )
    stiff = applied_robot(load_robot(tmp_path / "a"))
    assert len(stiff.passive) == 2
    assert model_of(stiff).nv == 2
    said = "\n".join(gaps_of(stiff))
    assert f"passive hinges, which are stiff here: {', '.join(stiff.passive)}" in said
    assert "as fitted beside the model: " in said
    assert "counterbalance on hinge_a" in said
    spec = read_spec(robot)
    configure(spec, "motor_friction_b", load_coefficient=0.03, element="element_b")
    configure(spec, "link_friction_b", coulomb=0.0, asymmetry=0.1)
    configure(spec, "link_friction_a", coulomb=1.0, asymmetry=0.2)
    spec.option.gravity = [0.0, 0.0, -9.8]
    spec.compile()
    (tmp_path / "b").mkdir()
    write_robot(robot, spec, robot.figures, tmp_path / "b", "")
    said = "\n".join(gaps_of(applied_robot(load_robot(tmp_path / "b"))))
    assert "friction of hinge_b, motor side, beyond its Coulomb level: load coefficient 0.03 (SI; " in said
    assert "friction of hinge_a, link side, beyond its Coulomb level: asymmetry 0.2 (" in said
    assert "friction of hinge_b, link side" not in said, "a share of no level says nothing"
    assert "gravity: (0, 0, -9.8) m/s^2" in said
    assert "passive" not in said
