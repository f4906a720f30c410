"""Loads that are pulled aside (a cable over a pulley, a load cell), not known as well as a weight that hangs."""

import numpy as np
from numpy.typing import NDArray

from bench.simulate.instruments import is_slanting, small_rotation

Array = NDArray[np.float64]


def pulled(wrench: Array, more: float, turn: Array) -> Array:
    """Return loads with those that are pulled aside larger by a share, and turned about the world's axes.

    Args:
        wrench: Shape (T, 6) [N, Nm], on the load point in world axes.
        more: Share.
        turn: Shape (3,) [rad], small, about x, y and z in this order.
    """
    matrix = np.eye(3)
    for angle, axis in zip(turn, np.eye(3), strict=True):
        matrix = small_rotation(angle * axis) @ matrix
    changed: Array = (1 + more) * np.concatenate([wrench[:, :3] @ matrix.T, wrench[:, 3:] @ matrix.T], axis=1)
    found: Array = np.where(is_slanting(wrench), changed, wrench)
    return found
