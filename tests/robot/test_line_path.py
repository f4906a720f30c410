"""A point along a straight line: plain kinematics against both engines, inverse kinematics against forward."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from bench.errors import ConvergenceError, InputError
from bench.identify.arm import Arm
from bench.robot.bodies import Point, RigidBodies, read_only
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.robot.kinematics import Placement, place, place_and_jacobian, rotation_vector, turn_onto, turned
from bench.robot.line_path import line_path, reach
from bench.robot.links import rigid_bodies

AGREEMENT = 1e-9  # [m], and without unit for rotations
POSES = 20
NEAR = np.deg2rad([0, 3, 38, 0, 49, 0])


@pytest.fixture(scope="module")
def hh150() -> CompiledRobot:
    return compile_robot(load_robot("hh150"))


@pytest.fixture(scope="module")
def bodies(hh150: CompiledRobot) -> RigidBodies:
    return rigid_bodies(hh150)


def test_plain_kinematics_agree_with_both_engines(
    hh150: CompiledRobot, bodies: RigidBodies, rng: np.random.Generator
) -> None:
    arm, data = Arm(bodies), mujoco.MjData(hh150.model)
    for q in rng.uniform(*hh150.limits.T, size=(POSES, 6)):
        data.qpos[hh150.at.theta] = q
        mujoco.mj_kinematics(hh150.model, data)
        for name, point in bodies.points.items():
            here, jacobian = place_and_jacobian(bodies, point, q)
            np.testing.assert_allclose(here.position, data.site(name).xpos, atol=AGREEMENT)
            np.testing.assert_allclose(here.rotation, data.site(name).xmat.reshape(3, 3), atol=AGREEMENT)
            np.testing.assert_allclose(jacobian, arm.jacobian(q, name), atol=AGREEMENT)


def test_a_slide_moves_along_its_axis(bodies: RigidBodies) -> None:
    railed = replace(bodies, is_hinge=np.array([False, True, True, True, True, True]))
    q, point = np.array([0.3, 0, 0, 0, 0, 0]), bodies.points["load_point"]
    here, jacobian = place_and_jacobian(railed, point, q)
    moved = here.position - place(railed, point, np.zeros(6)).position
    np.testing.assert_allclose(moved, 0.3 * jacobian[:3, 0], atol=AGREEMENT)
    np.testing.assert_array_equal(jacobian[3:, 0], 0)


def test_rotations(rng: np.random.Generator) -> None:
    for first, second in rng.standard_normal((POSES, 2, 3)):
        turn = turn_onto(first, second)
        np.testing.assert_allclose(
            turn @ first / np.linalg.norm(first), second / np.linalg.norm(second), atol=AGREEMENT
        )
        axis = first / np.linalg.norm(first)
        np.testing.assert_allclose(rotation_vector(turned(axis, 2.0)), 2.0 * axis, atol=AGREEMENT)
    np.testing.assert_allclose(turn_onto(second, -second) @ second, -second, atol=AGREEMENT)
    np.testing.assert_array_equal(turn_onto(second, 2 * second), np.eye(3))


def test_reach_is_the_inverse_of_forward_kinematics(bodies: RigidBodies, rng: np.random.Generator) -> None:
    point = bodies.points["load_point"]
    for _ in range(POSES):
        q = NEAR + rng.uniform(-0.3, 0.3, 6)
        found = reach(bodies, point, place(bodies, point, q), NEAR)
        np.testing.assert_allclose(found, q, atol=AGREEMENT)


def test_what_is_too_far_is_not_reached(bodies: RigidBodies) -> None:
    target = Placement(np.array([9.0, 0, 1]), np.eye(3))
    with pytest.raises(ConvergenceError, match="x = 9000"):
        reach(bodies, bodies.points["load_point"], target, NEAR, keep_rotation=False)


def test_the_path_is_straight_between_its_knots_too(bodies: RigidBodies, rng: np.random.Generator) -> None:
    tool = Point(5, read_only([0, 0, -0.4]), read_only(np.eye(3)))
    rotation = place(bodies, tool, NEAR).rotation
    start, end = np.array([1.2, 0.1, 0.799]), np.array([1.7, -0.1, 0.9])
    path = line_path(bodies, tool, start, end, NEAR, rotation, overrun=0.02)
    distance = rng.uniform(-0.02, path.length + 0.02, 200)
    for q, d in zip(path.at(distance), distance, strict=True):
        here = place(bodies, tool, q)
        np.testing.assert_allclose(here.position, start + d / path.length * (end - start), atol=AGREEMENT)
        np.testing.assert_allclose(here.rotation, rotation, atol=AGREEMENT)


def test_an_arm_of_two_joints_follows_a_line_in_its_plane(small_robot: Path) -> None:
    bodies = rigid_bodies(compile_robot(load_robot(small_robot)))
    point = bodies.points["hook"]
    start = place(bodies, point, np.array([0.3, 0.2])).position
    path = line_path(bodies, point, start, start + np.array([0.05, 0, 0.02]), np.array([0.3, 0.2]))
    end = place(bodies, point, path.at(np.array([path.length]))[0]).position
    np.testing.assert_allclose(end, start + np.array([0.05, 0, 0.02]), atol=AGREEMENT)


def test_the_place_where_a_joint_leaves_its_range_is_named(bodies: RigidBodies) -> None:
    tool = bodies.points["load_point"]
    limits = np.array(bodies.limits)
    limits[2, 0] = np.deg2rad(20)
    narrow = replace(bodies, limits=read_only(limits))
    start = place(bodies, tool, NEAR)
    with pytest.raises(InputError, match=r"joint 3's range, 20 to 54 deg, at x = \d+, .* mm from its start"):
        line_path(narrow, tool, start.position, start.position + np.array([0.6, 0, 0]), NEAR, start.rotation)
    with pytest.raises(InputError, match="cannot be followed"):
        line_path(bodies, tool, start.position, start.position + np.array([3, 0, 0]), NEAR, start.rotation)
