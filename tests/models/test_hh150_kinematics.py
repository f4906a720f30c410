"""hh150.xml against Table 1 and Eqs. (2), (3)."""

import json
from types import ModuleType

import mujoco
import numpy as np
import pytest

from tests.models.conftest import HH150, JOINTS, put, random_angles, rotor_dofs, theta_dofs

POSES = 200
EXACT = 1e-12  # [m], [-]: rounding of a product of six transforms
PRINTED = 1e-4  # [m]: configurations.json holds four decimals
LINKS = ("column", "upper_arm", "forearm", "forearm_tube", "wrist", "flange")


def test_tool_frame_is_the_product_of_eq_2(model, data, derive: ModuleType, rng) -> None:
    for _ in range(POSES):
        q = random_angles(model, rng)
        put(model, data, q)
        frame_6 = derive.arm.frames(q)[5]
        np.testing.assert_allclose(data.body("flange").xpos, frame_6[:3, 3], atol=EXACT)
        np.testing.assert_allclose(data.body("flange").xmat.reshape(3, 3), frame_6[:3, :3], atol=EXACT)


def test_every_body_stands_in_its_dh_origin_and_turns_about_its_dh_axis(model, data, derive: ModuleType, rng) -> None:
    for _ in range(POSES // 10):
        q = random_angles(model, rng)
        put(model, data, q)
        for i, (name, frame) in enumerate(zip(LINKS, derive.arm.frames(q), strict=True), start=1):
            np.testing.assert_allclose(data.body(name).xpos, frame[:3, 3], atol=EXACT)
            np.testing.assert_allclose(data.joint(f"joint{i}").xaxis, frame[:3, 2], atol=EXACT)


def test_zero_pose_is_the_reconstructed_one(model, data) -> None:
    put(model, data, np.zeros(6))
    np.testing.assert_allclose(data.body("wrist").xpos, [1.399, 0, 0.683 + 1.200], atol=EXACT)
    np.testing.assert_allclose(data.body("flange").xmat.reshape(3, 3)[:, 2], [-1, 0, 0], atol=EXACT)
    for name in LINKS[:5]:
        np.testing.assert_allclose(data.body(name).xmat.reshape(3, 3), np.eye(3), atol=EXACT)


@pytest.mark.parametrize(
    ("joint", "moved", "direction"),
    [(2, "wrist", (1.2, 0, -1.049)), (3, "wrist", (0, 0, -1.049)), (5, "load_point", (0.1108 * -1, 0, -0.3587))],
)
def test_signs_of_rotation(model, data, joint: int, moved: str, direction: tuple[float, float, float]) -> None:
    """+q2 leans forward, +q3 takes the forearm down, +q5 takes the tool down: velocity for 1 rad/s at zero."""
    put(model, data, np.zeros(6))
    jacobian = np.zeros((3, model.nv))
    point = data.site(moved).xpos if moved == "load_point" else data.body(moved).xpos
    mujoco.mj_jac(model, data, jacobian, None, point, model.body("flange").id)
    np.testing.assert_allclose(jacobian[:, theta_dofs(model)[joint - 1]], direction, atol=EXACT)


def test_jacobian_at_the_load_point(model, data, derive: ModuleType, rng) -> None:
    linear, angular = np.zeros((2, 3, model.nv))
    for _ in range(POSES // 10):
        q = random_angles(model, rng)
        put(model, data, q)
        mujoco.mj_jacSite(model, data, linear, angular, model.site("load_point").id)
        expected = derive.arm.jacobian(derive.arm.frames(q), 6, derive.arm.LOAD_POINT)
        np.testing.assert_allclose(linear[:, theta_dofs(model)], expected[0], atol=EXACT)
        np.testing.assert_allclose(angular[:, theta_dofs(model)], expected[1], atol=EXACT)
        assert not linear[:, rotor_dofs(model)].any()


def test_sites_are_the_points_of_set_a1(model, data) -> None:
    a1 = json.loads((HH150 / "paper" / "configurations.json").read_text())["A1"]
    foot = np.array([0, 0, 0.683])
    for q_deg, load, measured in zip(a1["q_deg"], a1["p_f_base"], a1["p_m_base"], strict=True):
        put(model, data, np.deg2rad(q_deg))
        np.testing.assert_allclose(data.site("load_point").xpos - foot, load, atol=PRINTED)
        np.testing.assert_allclose(data.site("reference_point").xpos - foot, measured, atol=PRINTED)


def test_a_wrench_on_the_load_body_acts_at_the_load_point(model, data, rng) -> None:
    """MuJoCo applies `xfrc_applied` at `xipos`; a massless body's has to be the load point."""
    put(model, data, random_angles(model, rng))
    np.testing.assert_allclose(data.body("load").xipos, data.site("load_point").xpos, atol=EXACT)
    assert model.body("load").mass[0] == 0
    assert model.body_subtreemass[model.body("load").id] == 0

    force, moment = 1e3 * rng.normal(size=(2, 3))
    without = data.qfrc_smooth.copy()
    data.xfrc_applied[model.body("load").id] = [*force, *moment]
    mujoco.mj_forward(model, data)
    linear, angular = np.zeros((2, 3, model.nv))
    mujoco.mj_jacSite(model, data, linear, angular, model.site("load_point").id)
    expected = linear.T @ force + angular.T @ moment
    np.testing.assert_allclose(data.qfrc_smooth - without, expected, atol=1e-9)  # [Nm], rounding of some kNm


def test_reflectors_give_an_orientation(model) -> None:
    points = np.array([model.site(f"reference_{name}").pos for name in ("point", "b", "c", "d")])
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    assert spread[1] > 0.3  # [m], far from a line
    assert spread[2] > 0.05  # [m], not in a plane either
    distances = np.linalg.norm(points[1:] - points[0], axis=1)
    assert distances.min() > 0.3
    assert distances.max() < 0.7


def test_ranges_are_those_of_table_1(model) -> None:
    degrees = [(-185, 185), (-40, 110), (-190, 54), (-350, 350), (-120, 120), (-350, 350)]
    ranges = np.array([model.joint(f"joint{i}").range for i in JOINTS])
    np.testing.assert_allclose(np.rad2deg(ranges), degrees, atol=1e-9)
    first_input = model.actuator_ctrladr[[model.actuator(f"servo{i}").id for i in JOINTS]]
    np.testing.assert_allclose(model.actuator_ctrlrange[first_input], ranges, atol=EXACT)
