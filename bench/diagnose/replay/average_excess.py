"""What a torque that is averaged along a motion has more than that of the averaged motion: dynamics are not linear.

Torques are averaged over a bin as accelerations are, and a replay has the arm where it is in the middle of the bin.
What goes with acceleration at one place is the same in both. Gravity and counterbalance bend over the angle (on the
HH-150 up to 11 Nm of joint 2 in ramps at 40 deg/s), inertia changes with it, and the square of an average speed is not
the average of squares. What links make of it is linear in their inertial parameters, so each world has its own.
"""

import numpy as np
from scipy.sparse import csr_array

from bench.diagnose.replay.segment_input import AverageExcess, Path, matrix_of
from bench.diagnose.replay.uneven_derivative import derivative_over
from bench.identify.arm import Arm
from bench.identify.dynamics.regressor import link_regressor
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.robot.links import rigid_bodies
from bench.simulate.prescribed import Motion

POINTS = 8  # effort: of a window at which torques are worked out; between them lie cubics


def average_excess(compiled: CompiledRobot, path: Path, motion: Motion) -> AverageExcess:
    """Return by how much averaged torques differ from those of the averaged motion, links rigid.

    Args:
        compiled: The robot, nominal; of its links only the geometry counts.
        path: Of a motion.
        motion: That motion in bins, in which joints that hardly moved stand.
    """
    arm = Arm(rigid_bodies(compiled))
    middle, speed = motion.q[motion.read], motion.velocity[motion.read]
    stands = np.all(motion.velocity == 0, axis=0)
    angles = np.where(stands, middle[0], path.angles)
    speeds = np.where(stands, 0.0, path.speeds)
    accelerations = np.where(stands, 0.0, derivative_over(path.angles, path.time, path.window, 2))
    step = max(1, path.window // POINTS)
    rows = np.unique(np.append(np.arange(0, len(path.time), step), len(path.time) - 1))
    average = matrix_of(path.of_torque, len(path.time)) @ cubics_between(path.time[rows], path.time)
    there = middle, speed, path.averaged(accelerations, path.groups)
    along = link_regressor(arm, angles[rows], speeds[rows], accelerations[rows])
    regressor = (average @ along.reshape(len(rows), -1)).reshape(len(middle), *along.shape[1:])
    balance = np.zeros_like(middle)
    if full := compiled.counterbalance:
        j = full.joint
        balance[:, j] = average @ full.torque(angles[rows, j]) - full.torque(middle[:, j])
    return AverageExcess(regressor - link_regressor(arm, *there), balance)


def cubics_between(nodes: Array, at: Array) -> csr_array:
    """Return what values at nodes count for those at other times on cubics through the four nearest, shape (T, nodes).

    Args:
        nodes: Shape (nodes,), rising, at least four.
        at: Shape (T,), within the nodes.
    """
    first = np.clip(np.searchsorted(nodes, at, side="right") - 2, 0, len(nodes) - 4)
    inside = first[:, None] + np.arange(4)
    away = at[:, None] - nodes[inside]
    weights = np.ones_like(away)
    for k in range(4):
        for other in set(range(4)) - {k}:
            weights[:, k] *= away[:, other] / (nodes[inside[:, k]] - nodes[inside[:, other]])
    starts = np.arange(0, weights.size + 1, 4)
    return csr_array((weights.ravel(), inside.ravel(), starts), shape=(len(at), len(nodes)))
