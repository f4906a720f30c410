"""A robot in a Rerun recording with another one, translucent, that it is compared with."""

import mujoco
import numpy as np

from bench.report.recording.arm import log_arm, log_standing_bodies
from bench.report.recording.cylinder import log_cylinder
from bench.report.recording.poses import Poses
from bench.report.recording.surroundings import log_load
from bench.report.recording.writer import RecordingWriter
from bench.robot.compiled import CompiledRobot
from bench.simulate.trace import Trace

ROBOT, GHOST = "robot/elastic", "robot/compared"
TRANSLUCENT = np.array([150, 190, 230, 70], dtype=np.uint8)


def log_compared(
    writer: RecordingWriter,
    scene: mujoco.MjModel,
    compiled: CompiledRobot,
    trace: Trace,
    robot: Poses,
    ghost: Poses,
    ghost_root: str = GHOST,
) -> None:
    """Log what stands about a robot, the robot with its load, and the one that it is compared with.

    Args:
        writer: Where to.
        scene: What no joint moves.
        compiled: The robot.
        trace: T instants, of the load.
        robot: Of the same instants, in its own colours.
        ghost: Of the same instants, translucent.
        ghost_root: Entity path of the translucent one.
    """
    log_standing_bodies(writer, "scene", scene)
    log_arm(writer, ROBOT, compiled, robot)
    log_cylinder(writer, f"{ROBOT}/counterbalance", compiled, robot)
    log_arm(writer, ghost_root, compiled, ghost, TRANSLUCENT)
    load_point = robot.site_position[:, compiled.at.load_point]
    log_load(writer, "robot/load", load_point, trace.wrench[:, :3], compiled.robot.figures.rating.force_n)
