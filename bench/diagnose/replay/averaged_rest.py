"""What a torque that is averaged along a motion has more than one in the middle: gravity and counterbalance bend.

Torques are averaged over a bin as accelerations are, and a replay has the arm where it is in the middle of the bin.
What goes with acceleration is the same in both; what holds the arm at rest is not, where that bends over the angle or
the arm speeds up: on the HH-150 up to 11 Nm of joint 2 in ramps at 40 deg/s. It is small, and known well enough from
the nominal model, and from how much is bolted on.
"""

import numpy as np
from scipy.interpolate import CubicSpline

from bench.diagnose.replay.segment_input import AveragedRest, Path
from bench.identify.arm import Arm
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.robot.links import rigid_bodies

POINTS = 8  # effort: of a window at which torques are worked out; what lies between is interpolated


def averaged_rest(compiled: CompiledRobot, path: Path, middle: Array) -> AveragedRest:
    """Return by how much averaged torques at rest differ from those in the middle.

    Args:
        compiled: The robot, nominal.
        path: Of a motion.
        middle: Shape (T, n), angles in the middle of the bins [rad] or [m].
    """
    arm = Arm(rigid_bodies(compiled))
    step = max(1, path.window // POINTS)
    rows = np.unique(np.append(np.arange(0, len(path.time), step), len(path.time) - 1))
    along, there = _holding(arm, compiled, path.angles[rows]), _holding(arm, compiled, middle)
    if step > 1:
        along = CubicSpline(path.time[rows], along)(path.time)
    averaged = np.stack([np.tensordot(weights, along[near], 1) for near, weights in path.of_torque])
    return AveragedRest(*np.moveaxis(averaged - there, 1, 0))


def _holding(arm: Arm, compiled: CompiledRobot, angles: Array) -> Array:
    """Return what holds the arm, and each kilogram at the load point, at rest, shape (rows, 2, n) [Nm] or [N]."""
    torque = arm.gravity(angles)
    if compiled.counterbalance is not None:
        j = compiled.counterbalance.joint
        torque[:, j] += compiled.counterbalance.torque(angles[:, j])
    moving = arm.jacobian(angles, compiled.robot.figures.load_point)[:, :3]
    return np.stack([torque, -np.einsum("k,mkn->mn", arm.bodies.gravity, moving)], axis=1)
