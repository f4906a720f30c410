"""Kinematics and statics of the arm against differences, energy, and forward kinematics written another way."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bench.errors import RobotError
from bench.identify.arm import Arm
from bench.robot.bodies import Point, RigidBodies, read_only
from tests.identify.hh150 import TABLE_1, hh150
from tests.identify.static_world import GRAVITY, frames, position

STEP = 1e-6  # [rad]; central differences: curvature 1e-12, rounding 1e-10 on lengths of metres
DIFFERENCE = 1e-8


@pytest.fixture(scope="module")
def arm() -> Arm:
    return Arm(hh150())


@pytest.fixture
def q(arm: Arm, rng: np.random.Generator) -> np.ndarray:
    return rng.uniform(*arm.bodies.limits.T, size=(20, 6))


def steps(q: np.ndarray):
    """Return q with each joint moved a little up and down, shape (2, n, ..., n)."""
    return np.array([[q + sign * STEP * np.eye(6)[j] for j in range(6)] for sign in (1, -1)])


def test_pose_is_the_product_of_table_1(arm: Arm, q: np.ndarray) -> None:
    np.testing.assert_allclose(arm.pose(q, "reflector_2")[0], position(q, "reflector_2"), atol=1e-12)
    np.testing.assert_allclose(arm.pose(q, "load")[1], frames(q)[0][:, 5], atol=1e-12)


def test_jacobian_is_the_derivative_of_the_pose(arm: Arm, q: np.ndarray) -> None:
    jacobian = arm.jacobian(q, "load")
    up, down = steps(q)
    for j in range(6):
        (p1, r1), (p0, r0) = arm.pose(up[j], "load"), arm.pose(down[j], "load")
        np.testing.assert_allclose(jacobian[:, :3, j], (p1 - p0) / (2 * STEP), atol=DIFFERENCE)
        turn = (r1 - r0) @ arm.pose(q, "load")[1].transpose(0, 2, 1) / (2 * STEP)
        spin = np.stack([turn[:, 2, 1], turn[:, 0, 2], turn[:, 1, 0]], axis=1)
        np.testing.assert_allclose(jacobian[:, 3:, j], spin, atol=DIFFERENCE)


def test_hessian_is_the_derivative_of_the_jacobian(arm: Arm, q: np.ndarray) -> None:
    hessian = arm.hessian(q, "load")
    up, down = steps(q)
    for j in range(6):
        difference = (arm.jacobian(up[j], "load") - arm.jacobian(down[j], "load")) / (2 * STEP)
        np.testing.assert_allclose(hessian[..., j], difference, atol=DIFFERENCE)


def test_complementary_stiffness_is_the_derivative_of_the_torque(
    arm: Arm, q: np.ndarray, rng: np.random.Generator
) -> None:
    wrench = np.concatenate([rng.normal(0, 1000, 3), rng.normal(0, 100, 3)])
    k_c = arm.complementary_stiffness(q, "load", np.tile(wrench, (len(q), 1)))
    up, down = steps(q)
    for j in range(6):
        torque = [arm.jacobian(moved, "load").transpose(0, 2, 1) @ wrench for moved in (up[j], down[j])]
        np.testing.assert_allclose(k_c[:, :, j], (torque[0] - torque[1]) / (2 * STEP), atol=1e3 * DIFFERENCE)


def test_gravity_is_the_derivative_of_the_potential(arm: Arm, q: np.ndarray) -> None:
    def potential(angles: np.ndarray) -> np.ndarray:
        rotation, origin = frames(angles)
        centres = [origin[:, i] + rotation[:, i] @ np.array(row.com) for i, row in enumerate(TABLE_1)]
        return -sum(row.mass * centre @ GRAVITY for row, centre in zip(TABLE_1, centres, strict=True))

    up, down = steps(q)
    slope = np.stack([(potential(up[j]) - potential(down[j])) / (2 * STEP) for j in range(6)], axis=1)
    np.testing.assert_allclose(arm.gravity(q), slope, atol=1e4 * DIFFERENCE)
    for j in range(6):
        difference = (arm.gravity(up[j]) - arm.gravity(down[j])) / (2 * STEP)
        np.testing.assert_allclose(arm.gravity_stiffness(q)[..., j], difference, atol=1e4 * DIFFERENCE)


def test_mass_matrix_is_what_inverse_dynamics_says(arm: Arm, q: np.ndarray) -> None:
    still = np.zeros(6)
    for row in q[:5]:
        columns = [arm.inverse_dynamics(row, still, unit) - arm.gravity(row) for unit in np.eye(6)]
        np.testing.assert_allclose(arm.mass_matrix(row), np.transpose(columns), atol=1e-9)


def test_unknown_point_names_the_known(arm: Arm) -> None:
    with pytest.raises(RobotError, match=r"unknown point of the arm 'reflektor_1'. Did you mean 'reflector_1'"):
        arm.pose(np.zeros(6), "reflektor_1")


def test_slides_and_branches_too(rng: np.random.Generator) -> None:
    """A tree: hinge, slide on it, and two hinges on the slide; the point hangs on one of them and not on the other."""
    turned = [Rotation.random(random_state=rng).as_matrix() for _ in range(4)]
    axes = rng.normal(size=(4, 3))
    bodies = RigidBodies(
        names=("a", "b", "c", "d"),
        parent=np.array([-1, 0, 1, 1]),
        is_hinge=np.array([True, False, True, True]),
        position=read_only(rng.normal(size=(4, 3))),
        rotation=read_only(turned),
        axis=read_only(axes / np.linalg.norm(axes, axis=1, keepdims=True)),
        mass=read_only(np.ones(4)),
        com=read_only(rng.normal(size=(4, 3))),
        inertia=read_only(np.tile(np.eye(3), (4, 1, 1))),
        limits=read_only([[-1, 1]] * 4),
        gravity=read_only([0, 0, -9.81]),
        points={"tip": Point(3, read_only(rng.normal(size=3)), read_only(np.eye(3)))},
    )
    tree, angles = Arm(bodies), rng.normal(size=4)
    jacobian, hessian = tree.jacobian(angles, "tip"), tree.hessian(angles, "tip")
    assert not jacobian[:, 2].any(), "c does not move the tip"
    for j, unit in enumerate(np.eye(4)):
        up, down = angles + STEP * unit, angles - STEP * unit
        moved = (tree.pose(up, "tip")[0] - tree.pose(down, "tip")[0]) / (2 * STEP)
        np.testing.assert_allclose(jacobian[:3, j], moved, atol=DIFFERENCE)
        turned = (tree.jacobian(up, "tip") - tree.jacobian(down, "tip")) / (2 * STEP)
        np.testing.assert_allclose(hessian[:, :, j], turned, atol=DIFFERENCE)
