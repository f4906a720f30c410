"""What sits in a nest turns with the tool."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.robot.turned_sites import TurnedSites


@pytest.fixture(scope="module", params=["hh150", "small"])
def compiled(request: pytest.FixtureRequest, small_robot: Path) -> CompiledRobot:
    return compile_robot(load_robot(small_robot if request.param == "small" else request.param))


def test_axes_of_a_site_are_those_of_mujoco(compiled: CompiledRobot) -> None:
    model, at = compiled.model, compiled.at
    data, rng = mujoco.MjData(model), np.random.default_rng(1)
    theta = rng.uniform(-1, 1, (5, compiled.n_joints))
    offset = rng.normal(size=(len(at.reflectors), 3))
    assert len(offset)
    moved = TurnedSites.reflectors_of(compiled).moved(theta, offset)
    for row, angles in zip(moved, theta, strict=True):
        data.qpos[at.theta] = angles
        mujoco.mj_kinematics(model, data)
        for k, site in enumerate(at.reflectors):
            axes = data.xmat[model.site_bodyid[site]].reshape(3, 3)
            np.testing.assert_allclose(row[k], axes @ offset[k], atol=1e-12)
        np.testing.assert_allclose(TurnedSites.reflectors_of(compiled).at(angles, offset), row, atol=1e-12)
