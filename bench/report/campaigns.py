"""A campaign folder together with the robot that it names."""

import os
from pathlib import Path

import mujoco
import numpy as np

from bench.record.campaign import Arm
from bench.record.check import check_with_robot
from bench.record.finding import Report
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot


def open_campaign(folder: Path, robot: str = "") -> tuple[Report, CompiledRobot | None]:
    """Check a campaign, with the joints and limits of its robot once the tables can be read.

    Args:
        folder: Of the campaign.
        robot: Name or folder of the robot to take; "": the one that the campaign names.

    Returns:
        What the check found, and the robot; None where the campaign cannot be read.

    Raises:
        RobotError: The campaign's robot is unknown or broken.
    """
    found: list[CompiledRobot] = []

    def arm_of(name: str) -> Arm:
        found.append(compile_robot(load_robot(robot or robot_of(folder, name))))
        return plain_arm(found[0])

    report = check_with_robot(folder, arm_of)
    return report, found[0] if found else None


def robot_of(folder: Path, name: str) -> str:
    """Return the robot that a campaign folder names: a folder within it, or else the name as it stands."""
    beside = folder.absolute() / name  # absolute: a robot that comes along may have the same name
    return str(beside) if os.path.isdir(beside) else name  # noqa: PTH112  a name may be too long for pathlib


def plain_arm(compiled: CompiledRobot) -> Arm:
    """Return what a check needs to know of a robot."""
    model, at = compiled.model, compiled.at
    limits = np.where(model.jnt_limited[at.joint, None].astype(bool), compiled.limits, [-np.inf, np.inf])
    is_slide = model.jnt_type[at.joint] == mujoco.mjtJoint.mjJNT_SLIDE
    return Arm(tuple(bool(slide) for slide in is_slide), tuple((float(low), float(high)) for low, high in limits))
