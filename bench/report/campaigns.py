"""A campaign folder together with the robot that it names."""

import os
from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np

from bench.diagnose.replay.known import known_faults
from bench.errors import UnknownRobotError
from bench.record.campaign import Arm, Campaign
from bench.record.check import check_with_robot
from bench.record.finding import Finding, Report
from bench.record.logs.likewise import listed
from bench.record.manifest import MANIFEST
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import Robot, load_robot


def open_campaign(folder: Path, robot: str | Robot = "") -> tuple[Report, CompiledRobot | None]:
    """Check a campaign, with the joints and limits of its robot once the tables can be read.

    Args:
        folder: Of the campaign.
        robot: The robot to take, its name or its folder; "": the one that the campaign names.

    Returns:
        What the check found, and the robot; None where the campaign cannot be read.

    Raises:
        RobotError: The campaign's robot is unknown or broken.
    """
    found: list[CompiledRobot] = []

    def arm_of(name: str) -> Arm:
        taken = robot if isinstance(robot, Robot) else load_robot(robot) if robot else robot_of(folder, name)
        found.append(compile_robot(taken))
        return plain_arm(found[0])

    report = check_with_robot(folder, arm_of)
    if not found or report.campaign is None:
        return report, found[0] if found else None
    if faults := tuple(faults_with_robot(report.campaign, found[0])):
        return Report(folder, (*faults, *report.findings), None), found[0]
    return report, found[0]


def open_usable(folder: Path, robot: str = "") -> tuple[Campaign, CompiledRobot]:
    """Return a campaign without errors, and its robot; arguments as in `open_campaign`.

    Raises:
        CampaignError: The folder is not a usable campaign; every fault is listed.
        RobotError: The campaign's robot is unknown or broken.
    """
    report, compiled = open_campaign(folder, robot)
    campaign = report.usable()
    assert compiled is not None  # a usable campaign comes with its robot
    return campaign, compiled


def faults_with_robot(campaign: Campaign, compiled: CompiledRobot) -> Iterator[Finding]:
    """Yield an error for what a robot's figures do not say or cannot have, and a campaign needs."""
    yield from unknown_constants(campaign, compiled)
    for key, words in known_faults(campaign, compiled):
        yield Finding("error", MANIFEST, None, key, words, "correct it, or leave it out")


def unknown_constants(campaign: Campaign, compiled: CompiledRobot) -> Iterator[Finding]:
    """Yield an error where currents are logged of drives whose torque constant nobody wrote down."""
    drives = compiled.robot.figures.drives
    columns = [f"current_{j}_a" for j, drive in enumerate(drives, start=1) if not drive.states_torque_constant]
    logged = [name for name in columns if any(name in run.columns for run in campaign.runs)]
    if not logged:
        return
    place = f"{compiled.robot.folder.name}/figures.yaml"
    message = f"states no torque_constant_nm_per_a of its drives, and the campaign has {listed(logged)}"
    remedy = (
        "write how many Nm at the joint one A makes (motor constant times gear ratio), or let "
        "`bench convert --look LOG --robot DIR` estimate it against the masses; leave out currents that are not needed"
    )
    yield Finding("error", place, None, "drives", message, remedy)


def robot_of(folder: Path, name: str) -> Robot:
    """Return the robot that a campaign names: a folder within it, or else one of that name.

    Raises:
        UnknownRobotError: There is none; with the file that names it.
        RobotError: Its folder is broken.
    """
    beside = folder.absolute() / name  # absolute: a robot that comes along may have the same name
    is_beside = os.path.isdir(beside)  # noqa: PTH112  a name may be too long for pathlib
    try:
        return load_robot(beside if is_beside else name)
    except UnknownRobotError as error:
        raise UnknownRobotError(f"{folder / MANIFEST}: robot: {error}") from error


def plain_arm(compiled: CompiledRobot) -> Arm:
    """Return what a check needs to know of a robot."""
    model, at = compiled.model, compiled.at
    limits = np.where(model.jnt_limited[at.joint, None].astype(bool), compiled.limits, [-np.inf, np.inf])
    is_slide = model.jnt_type[at.joint] == mujoco.mjtJoint.mjJNT_SLIDE
    return Arm(
        tuple(bool(slide) for slide in is_slide),
        tuple((float(low), float(high)) for low, high in limits),
        tuple(drive.gear_ratio for drive in compiled.robot.figures.drives),
        len(compiled.robot.figures.reflectors),
    )
