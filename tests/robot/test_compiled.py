"""The two engines describe the same robot; broken robot folders are told apart."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import yaml

from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.errors import RobotError
from bench.identify.arm import Arm
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.robot.links import rigid_bodies
from bench.robot.mass_matrix import link_mass_matrix

AGREEMENT = 1e-9  # DESIGN section 5: pose [m], Jacobian, gravity torque [Nm] per 1e3 Nm, mass matrix per 1e3 kg m^2
POSES = 50

Content = dict[str, Any]
Edit = Callable[[Content, str], tuple[Content, str]]


@pytest.fixture(scope="module", params=["small", "hh150"])
def compiled(request: pytest.FixtureRequest, small_robot: Path) -> CompiledRobot:
    return compile_robot(load_robot(small_robot if request.param == "small" else request.param))


def test_mujoco_and_pinocchio_agree(compiled: CompiledRobot, rng: np.random.Generator) -> None:
    arm = Arm(rigid_bodies(compiled))
    model, at = compiled.model, compiled.at
    data = mujoco.MjData(model)
    figures = compiled.robot.figures
    for q in rng.uniform(*compiled.limits.T, size=(POSES, compiled.n_joints)):
        data.qpos[at.theta] = q
        mujoco.mj_forward(model, data)
        for name in (*figures.reflectors, figures.load_point):
            site = model.site(name).id
            position, rotation = arm.pose(q, name)
            np.testing.assert_allclose(position, data.site_xpos[site], rtol=0, atol=AGREEMENT)
            np.testing.assert_allclose(rotation, data.site_xmat[site].reshape(3, 3), rtol=0, atol=AGREEMENT)
            jacobian = np.zeros((2, 3, model.nv))
            mujoco.mj_jacSite(model, data, jacobian[0], jacobian[1], site)
            expected = jacobian.reshape(6, -1)[:, at.theta_dof]
            np.testing.assert_allclose(arm.jacobian(q[None], name)[0], expected, rtol=0, atol=AGREEMENT)
        gravity = data.qfrc_bias[at.theta_dof]  # at zero velocity
        np.testing.assert_allclose(arm.gravity(q[None])[0], gravity, rtol=AGREEMENT, atol=1e3 * AGREEMENT)
        expected = link_mass_matrix(compiled, q)
        np.testing.assert_allclose(arm.mass_matrix(q), expected, rtol=AGREEMENT, atol=1e3 * AGREEMENT)


def test_counterbalance_in_closed_form_and_in_the_model(compiled: CompiledRobot, rng: np.random.Generator) -> None:
    """Length, lever arm, force, torque against MuJoCo's tendon and the plugin; k_b against a difference quotient."""
    closed = compiled.counterbalance
    assert closed is not None
    model, at = compiled.model, compiled.at
    data = mujoco.MjData(model)
    dof = at.theta_dof[closed.joint]

    def torque(angle: float) -> float:
        data.qpos[at.theta[closed.joint]] = angle
        mujoco.mj_forward(model, data)
        jacobian = np.zeros(model.nv)
        moment = np.zeros((model.nactuator, model.nv))
        mujoco.mju_sparse2dense(
            moment, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind
        )
        jacobian[:] = moment[at.counterbalance]
        np.testing.assert_allclose(data.ten_length[at.counterbalance_tendon], closed.length(angle), atol=AGREEMENT)
        np.testing.assert_allclose(jacobian[dof], closed.lever_arm(angle), atol=AGREEMENT)
        pull = -data.actuator_force[at.counterbalance]
        np.testing.assert_allclose(pull, closed.force(angle), rtol=AGREEMENT)
        np.testing.assert_allclose(pull * jacobian[dof], closed.torque(angle), rtol=AGREEMENT, atol=1e3 * AGREEMENT)
        return float(pull * jacobian[dof])

    step = 1e-5  # [rad]; error of the central difference: rounding 1e-12 * M / step, curvature step^2
    for angle in rng.uniform(*compiled.limits[closed.joint], size=POSES):
        quotient = (torque(angle + step) - torque(angle - step)) / (2 * step)
        np.testing.assert_allclose(closed.stiffness(angle), quotient, rtol=1e-6, atol=1e-2)


def broken(small_robot: Path, tmp_path: Path, edit: Edit) -> Path:
    folder = shutil.copytree(small_robot, tmp_path / "broken")
    figures, mjcf = yaml.safe_load((folder / "figures.yaml").read_text()), (folder / "small.xml").read_text()
    figures, mjcf = edit(figures, mjcf)
    (folder / "figures.yaml").write_text(yaml.safe_dump(figures))
    (folder / "small.xml").write_text(mjcf)
    return folder


def rename_rotor(figures: Content, mjcf: str) -> tuple[Content, str]:
    figures["drives"][1]["rotor"] = "rotor_c"
    figures["drives"][0]["element"] = "spring_a"
    return figures, mjcf


def negative_mass(figures: Content, mjcf: str) -> tuple[Content, str]:
    return figures, mjcf.replace('mass="25.0"', 'mass="-25.0"')


def unknown_key(figures: Content, mjcf: str) -> tuple[Content, str]:
    figures["rating"]["force_kg"] = 12
    return figures, mjcf


def misplaced_load(figures: Content, mjcf: str) -> tuple[Content, str]:
    return figures, re.sub(r'(<body name="load" .*?>)<inertial.*?/>', r"\1", mjcf)


def undriven_joint(figures: Content, mjcf: str) -> tuple[Content, str]:
    return figures, mjcf.replace(
        '<body name="load"', '<body name="extra"><joint/><geom size="1"/></body><body name="load"'
    )


def shifted_zero(figures: Content, mjcf: str) -> tuple[Content, str]:
    return figures, mjcf.replace('name="hinge_b" axis', 'name="hinge_b" ref="0.1" axis')


def replaced(old: str, new: str) -> Edit:
    def edit(figures: Content, mjcf: str) -> tuple[Content, str]:
        assert old in mjcf
        return figures, mjcf.replace(old, new, 1)

    return edit


def rotor_is_the_link(figures: Content, mjcf: str) -> tuple[Content, str]:
    figures["drives"][0]["rotor"] = "hinge_a"
    return figures, mjcf


def tracker_without_reflectors(figures: Content, mjcf: str) -> tuple[Content, str]:
    figures["reflectors"] = []
    return figures, mjcf


def gauge_without_cylinder(figures: Content, mjcf: str) -> tuple[Content, str]:
    del figures["counterbalance"]
    return figures, mjcf


def encoder_on_no_joint(figures: Content, mjcf: str) -> tuple[Content, str]:
    figures["instruments"]["link_encoder"] = {"joints": ["hinge_c"]}
    return figures, mjcf


def too_many_sigmas(figures: Content, mjcf: str) -> tuple[Content, str]:
    figures["instruments"]["torque"] = {"sigma_nm": [1, 2, 3]}
    return figures, mjcf


def too_few_offsets(figures: Content, mjcf: str) -> tuple[Content, str]:
    figures["instruments"]["torque"] = {"sigma_nm": 1, "offset_sigma_nm": [3]}
    return figures, mjcf


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (rename_rotor, r"drives\[1\]\.rotor: .*'rotor_c'.* mean 'rotor_b'[\s\S]*drives\[0\]\.element: .*'spring_a'"),
        (negative_mass, r"small\.xml: .*'fore'.*; give the body positive mass and inertia"),
        (replaced('mass="25.0"', 'mass="0"'), r"small\.xml: .*'fore'.*; give the body positive mass and inertia"),
        (rotor_is_the_link, r"drives\[0\]\.rotor: 'hinge_a' is the link's joint; add a rotor"),
        (replaced('armature="40.0"', ""), r"drives\[0\]\.rotor: 'rotor_a' has no armature; write J_m N\^2"),
        (replaced('stiffness="200000.0"', ""), r"drives\[0\]\.element: tendon 'element_a' has no stiffness"),
        (replaced('coef="1"', 'coef="2"'), r"drives\[0\]\.element: tendon 'element_a' must be <fixed>"),
        (replaced('"servo_a" joint="rotor_a"', '"servo_a" joint="hinge_a"'), r"drives\[0\]\.servo: .*'rotor_a'"),
        (replaced('"servo_a" joint="rotor_a"', '"servo_a" joint="hinge_q"'), r"'hinge_q'.*name a joint or tendon"),
        (replaced('joint="rotor_a" coef', 'joint="rotor_q" coef'), r"'rotor_q' not found.*name a joint or site"),
        (tracker_without_reflectors, r"instruments\.tracker needs reflectors"),
        (gauge_without_cylinder, r"instruments\.pressure needs a counterbalance"),
        (encoder_on_no_joint, r"link_encoder\.joints: unknown driven joint 'hinge_c'"),
        (too_many_sigmas, r"torque\.sigma_nm needs one number, or one for each of the 2 drives"),
        (too_few_offsets, r"torque\.offset_sigma_nm needs one number, or one for each of the 2 drives"),
        (unknown_key, r"rating\.force_kg"),
        (misplaced_load, r"body 'load' must have its centre of mass at site 'hook'"),
        (undriven_joint, r"body 'extra' has a joint that no drive"),
        (shifted_zero, r"ref != 0"),
    ],
)
def test_a_broken_folder_is_told_what_is_wrong(small_robot: Path, tmp_path: Path, edit: Edit, said: str) -> None:
    folder = broken(small_robot, tmp_path, edit)
    with pytest.raises(RobotError, match=said):
        rigid_bodies(compile_robot(load_robot(folder)))


def test_a_base_that_rocks_on_springs_stands_for_the_links() -> None:
    """`bench predict` refused a robot that was handed over with such a base, for a joint that no drive names."""
    hh150, effect = compile_robot(load_robot("hh150")), catalogue()["base_compliance"]
    (place,) = effect.places(hh150)
    edit = effect.edit(place, {"compliance": 5e-8}, Conditions.reference(6))
    assert edit
    rocking, rigid = rigid_bodies(compile_robot(hh150.robot, [edit])), rigid_bodies(hh150)
    for name in ("mass", "com", "inertia", "position"):
        np.testing.assert_allclose(getattr(rocking, name), getattr(rigid, name), atol=1e-12)


def test_a_list_is_not_called_too_short_because_of_what_is_wrong_in_it(small_robot: Path, tmp_path: Path) -> None:
    def stand(figures: Content, mjcf: str) -> tuple[Content, str]:
        for drive in figures["drives"]:
            drive["speed_limit_rad_per_s"] = -1
        return figures, mjcf

    with pytest.raises(RobotError) as raised:
        load_robot(broken(small_robot, tmp_path, stand))
    assert [problem.split(": ")[1] for problem in raised.value.problems] == [
        f"drives[{j}].speed_limit_rad_per_s" for j in (0, 1)
    ]
