"""Where every body of the robot is at given joint angles. Kinematics only: nothing is simulated here."""

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.robot.bodies import Array, read_only
from bench.robot.compiled import CompiledRobot
from bench.simulate.trace import Trace


@dataclass(frozen=True)
class Poses:
    """A robot at T instants, in the world frame.

    Attributes:
        body_position: Shape (T, nbody, 3) [m].
        body_quaternion: Shape (T, nbody, 4), w x y z.
        site_position: Shape (T, nsite, 3) [m].
    """

    body_position: Array
    body_quaternion: Array
    site_position: Array

    def __len__(self) -> int:
        return len(self.body_position)


def poses_at(compiled: CompiledRobot, theta: Array, q: Array) -> Poses:
    """Return the poses of all bodies for link angles `theta` and motor angles `q`, both shape (T, n) [rad]."""
    model, at = compiled.model, compiled.at
    scratch = mujoco.MjData(model)
    position = np.empty((len(theta), model.nbody, 3))
    quaternion = np.empty((len(theta), model.nbody, 4))
    site = np.empty((len(theta), model.nsite, 3))
    for i, (links, rotors) in enumerate(zip(theta, q, strict=True)):
        scratch.qpos[at.theta] = links
        scratch.qpos[at.q] = rotors
        mujoco.mj_kinematics(model, scratch)
        position[i], quaternion[i], site[i] = scratch.xpos, scratch.xquat, scratch.site_xpos
    return Poses(read_only(position), read_only(quaternion), read_only(site))


def rigid_poses(compiled: CompiledRobot, trace: Trace) -> Poses:
    """Return the poses of the robot as if it were rigid: every link at its motor angle, theta = q."""
    return poses_at(compiled, trace.q, trace.q)


def elastic_poses(compiled: CompiledRobot, trace: Trace, magnification: float) -> Poses:
    """Return the poses with the wind-up of the elastic elements magnified: theta = q + magnification (theta - q)."""
    return poses_at(compiled, trace.q + magnification * (trace.theta - trace.q), trace.q)
