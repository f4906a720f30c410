"""What rigid links need along a motion, by recursive Newton-Euler: beside the regressor that identification uses."""

import numpy as np

from bench.identify.arm import Arm
from bench.identify.drive_model import Motion
from bench.record.campaign import Array
from bench.robot.bodies import RigidBodies


def link_torque(bodies: RigidBodies, motion: Motion) -> Array:
    """Return the torque that links need along a motion, shape (T, n)."""
    arm = Arm(bodies)
    states = zip(motion.position, motion.velocity, motion.acceleration, strict=True)
    return np.array([arm.inverse_dynamics(*state) for state in states])
