"""Housing and rod fit the cylinder over its stroke."""

import mujoco
import numpy as np
import pytest

from bench.report.recording.cylinder import anchors_of, telescope, turned_to
from bench.report.recording.poses import rigid_poses
from bench.robot.compiled import CompiledRobot
from bench.simulate.session import Film


@pytest.mark.parametrize("stroke", [(0.5, 0.5), (0.5, 0.7), (0.5, 0.9)])
def test_rod_stays_in_the_housing(stroke: tuple[float, float]) -> None:
    parts = telescope(np.array(stroke))
    assert 0 < parts.housing < stroke[0]  # does not reach the moving anchor
    assert 0 < parts.rod <= stroke[0]  # does not stick out beyond the fixed anchor
    assert parts.housing + parts.rod >= stroke[1]  # no gap when it is out farthest


def test_z_axis_turns_to_the_direction(rng: np.random.Generator) -> None:
    directions = np.vstack([rng.standard_normal((20, 3)), [[0, 0, 2.0], [0, 0, -3.0]]])
    for direction, quaternion in zip(directions, turned_to(directions), strict=True):
        turned = np.empty(3)
        mujoco.mju_rotVecQuat(turned, np.array([0.0, 0.0, 1.0]), quaternion)
        np.testing.assert_allclose(turned, direction / np.linalg.norm(direction), atol=1e-12)


def test_anchors_are_as_far_apart_as_the_tendon_is_long(compiled: CompiledRobot, film: Film) -> None:
    fixed, moving = anchors_of(compiled, rigid_poses(compiled, film.trace))
    closed = compiled.counterbalance
    assert closed
    np.testing.assert_allclose(
        np.linalg.norm(moving - fixed, axis=1), closed.length(film.trace.q[:, closed.joint]), rtol=1e-12
    )
