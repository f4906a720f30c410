"""What a torque that is averaged along a motion has more than one in the middle: gravity and counterbalance bend.

Torques are averaged over a bin as accelerations are, and a replay has the arm where it is in the middle of the bin.
What goes with acceleration is the same in both; what holds the arm at rest is not, where that bends over the angle or
the arm speeds up: on the HH-150 up to 11 Nm of joint 2 in ramps at 40 deg/s. It is small and known well enough from the
nominal model, and from what runs say that is bolted on.
"""

import numpy as np
from scipy.interpolate import CubicSpline

from bench.diagnose.replay.segment_input import Path
from bench.identify.arm import Arm
from bench.record.campaign import Array, Run
from bench.robot.compiled import CompiledRobot
from bench.robot.links import rigid_bodies

POINTS = 8  # effort: of a window at which torques are worked out; what lies between is interpolated


def averaged_rest(run: Run, compiled: CompiledRobot, path: Path, middle: Array) -> Array:
    """Return by how much the averaged torque at rest differs from that in the middle, shape (T, n) [Nm] or [N].

    Args:
        run: A motion; of it, what is bolted on.
        compiled: Its robot, nominal.
        path: Of the motion.
        middle: Shape (T, n), angles in the middle of the bins [rad] or [m].
    """
    arm = Arm(rigid_bodies(compiled))
    masses = run.columns.get("load_mass_kg", np.zeros(len(run)))
    step = max(1, path.window // POINTS)
    rows = np.unique(np.append(np.arange(0, len(path.time), step), len(path.time) - 1))
    along = _holding(arm, compiled, path.angles[rows], masses[rows])
    if step > 1:
        along = CubicSpline(path.time[rows], along)(path.time)
    carried = np.array([masses[group].mean() for group in path.groups])
    averaged = np.stack([weights @ along[there] for there, weights in path.of_torque])
    return np.asarray(averaged - _holding(arm, compiled, middle, carried))


def _holding(arm: Arm, compiled: CompiledRobot, angles: Array, masses: Array) -> Array:
    """Return what holds the arm and the masses on it at rest, shape (rows, n) [Nm] or [N]."""
    torque = arm.gravity(angles)
    if np.any(masses):
        lift = arm.jacobian(angles, compiled.robot.figures.load_point)[:, :3]
        torque -= masses[:, None] * np.einsum("k,mkn->mn", arm.bodies.gravity, lift)
    if compiled.counterbalance is not None:
        j = compiled.counterbalance.joint
        torque[:, j] += compiled.counterbalance.torque(angles[:, j])
    return torque
