"""The arm as plain numbers: a tree of rigid bodies, without MuJoCo and without Pinocchio.

This is the bridge between the two engines. `bench.robot.links` fills it from a compiled `MjModel`; `bench.identify`
builds its Pinocchio model from it. So both describe the same robot, and neither imports the other.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def read_only(values: object) -> Array:
    """Return a float64 copy of `values` that cannot be written to."""
    array = np.array(values, dtype=np.float64)
    array.flags.writeable = False
    return array


@dataclass(frozen=True)
class Point:
    """A named point that moves with one body of the arm (a site of the MJCF).

    Attributes:
        body: Index of the body it is fixed to; -1 is the base.
        position: Shape (3,) [m], in the frame of that body's joint.
        rotation: Shape (3, 3), orientation in the frame of that body's joint.
    """

    body: int
    position: Array
    rotation: Array


@dataclass(frozen=True)
class RigidBodies:
    """The links of the arm; body i is moved by joint i. A rotor is no link; where it sits on one, it adds its mass.

    The frame of body i sits at joint i and turns (or slides) with it. Its placement is given in the frame of its parent
    with all joints at zero; the base frame is the world. Bodies without a joint are merged into their parent.

    Attributes:
        names: Joint names, length n.
        parent: Shape (n,), index of the parent body, -1 for the base. parent[i] < i.
        is_hinge: Shape (n,) bool; a joint that is not a hinge is a slide.
        position: Shape (n, 3) [m], placement of joint frame i in the parent frame at q = 0.
        rotation: Shape (n, 3, 3), orientation of joint frame i in the parent frame at q = 0.
        axis: Shape (n, 3), unit vector of joint i in its own frame.
        mass: Shape (n,) [kg].
        com: Shape (n, 3) [m], centre of mass in the joint frame.
        inertia: Shape (n, 3, 3) [kg m^2], about the centre of mass, in the axes of the joint frame.
        limits: Shape (n, 2) [rad] or [m].
        gravity: Shape (3,) [m/s^2], in the world frame.
        points: Named points.
    """

    names: tuple[str, ...]
    parent: NDArray[np.int64]
    is_hinge: NDArray[np.bool_]
    position: Array
    rotation: Array
    axis: Array
    mass: Array
    com: Array
    inertia: Array
    limits: Array
    gravity: Array
    points: Mapping[str, Point]

    @property
    def n_joints(self) -> int:
        """Number of joints of the arm."""
        return len(self.names)
