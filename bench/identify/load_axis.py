"""Joints that no load turns: the load point lies on their axis, whatever the pose."""

import numpy as np
from numpy.typing import NDArray

from bench.identify.arm import Arm

POSES = 16  # effort: a lever that vanishes in so many poses drawn at random vanishes in all
ON_AXIS = 1e-5  # derived: of the longest lever; angles of axes are written to five digits (1.5708 is 4e-6 off)


def turned_by_load(arm: Arm, load_point: str) -> NDArray[np.bool_]:
    """Return which joints a force at the load point turns or pushes in some pose, shape (n,) bool."""
    low, high = arm.bodies.limits.T
    hinge = arm.bodies.is_hinge
    low, high = np.where(hinge, np.maximum(low, -np.pi), low), np.where(hinge, np.minimum(high, np.pi), high)
    rng = np.random.default_rng(0)  # part of the rule: the same arm gives the same answer
    moved = arm.jacobian(rng.uniform(low, high, (POSES, arm.n_joints)), load_point)[:, :3]
    lever = np.linalg.norm(moved, axis=1).max(axis=0)
    turned: NDArray[np.bool_] = lever > ON_AXIS * lever.max()
    return turned


def on_axis_sentence(name: str) -> str:
    """Return that no load turns a joint, and what to do."""
    return (
        f"The load point lies on the axis of {name}, so in no pose does a load there turn it; hang the load beside "
        "that axis, and name the place `load_point` in figures.yaml."
    )
