"""The scene that a robot stands in: floor, plinth, and whatever else its folder puts around it."""

import mujoco
import numpy as np

from bench.errors import RobotError
from bench.robot.compiled import CompiledRobot
from bench.robot.trial import expect_harmless


def scene_of(compiled: CompiledRobot) -> mujoco.MjModel:
    """Return the compiled scene that the robot's figures name, or the robot alone if they name none.

    Raises:
        RobotError: The scene does not compile.
    """
    robot = compiled.robot
    if robot.figures.scene is None:
        return compiled.model
    path = robot.folder / robot.figures.scene
    expect_harmless(path)
    try:
        return mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        raise RobotError(f"{path}: {error}") from error


def floor_height(scene: mujoco.MjModel) -> float:
    """Return the height of the first plane of a scene [m], or 0 without one."""
    planes = np.flatnonzero(scene.geom_type == mujoco.mjtGeom.mjGEOM_PLANE)
    return float(scene.geom_pos[planes[0], 2]) if len(planes) else 0.0
