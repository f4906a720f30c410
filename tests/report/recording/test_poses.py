"""Kinematics for drawing: at the true angles they give the true points, and magnification acts on the wind-up alone."""

import mujoco
import numpy as np

from bench.report.recording.poses import elastic_poses, poses_at, rigid_poses
from bench.robot.compiled import CompiledRobot
from bench.simulate.session import Film

ROUNDING = 1e-12  # [m], of a short chain of rotations in double precision


def test_magnification_one_is_the_truth(compiled: CompiledRobot, film: Film) -> None:
    poses = elastic_poses(compiled, film.trace, 1.0)
    seen = poses.site_position[:, compiled.at.reflectors]
    np.testing.assert_allclose(seen, film.trace.reflectors, rtol=0, atol=ROUNDING)


def test_magnification_zero_is_the_rigid_robot(compiled: CompiledRobot, film: Film) -> None:
    elastic, rigid = elastic_poses(compiled, film.trace, 0.0), rigid_poses(compiled, film.trace)
    np.testing.assert_array_equal(elastic.body_position, rigid.body_position)
    np.testing.assert_array_equal(elastic.body_quaternion, rigid.body_quaternion)
    np.testing.assert_array_equal(elastic.site_position, rigid.site_position)


def test_small_deflection_grows_with_magnification(compiled: CompiledRobot, film: Film) -> None:
    rigid = rigid_poses(compiled, film.trace).site_position
    moved = [elastic_poses(compiled, film.trace, m).site_position - rigid for m in (1e-3, 2e-3)]
    np.testing.assert_allclose(moved[1], 2 * moved[0], rtol=1e-3, atol=ROUNDING)


def test_bodies_stand_where_mujoco_puts_them(compiled: CompiledRobot, rng: np.random.Generator) -> None:
    theta, q = rng.uniform(-1, 1, (2, 5, compiled.n_joints))
    poses = poses_at(compiled, theta, q)
    data = mujoco.MjData(compiled.model)
    for i in range(5):
        data.qpos[compiled.at.theta], data.qpos[compiled.at.q] = theta[i], q[i]
        mujoco.mj_forward(compiled.model, data)
        np.testing.assert_allclose(poses.body_position[i], data.xpos, rtol=0, atol=ROUNDING)
        np.testing.assert_allclose(poses.body_quaternion[i], data.xquat, rtol=0, atol=ROUNDING)
    assert len(poses) == 5
