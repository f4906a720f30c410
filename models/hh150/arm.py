"""The arm of the HH-150 in NumPy: what the paper gives, what was reconstructed from it, and its statics and inertia.

This is a second model beside hh150.xml, written from Table 1 and Eq. (2). derive.py computes the numbers of the XML
with it, so that they do not come out of the file that they go into. Equations and tables are the paper's, see
paper/README.md.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
DEG = np.pi / 180.0
GRAVITY = 9.81  # [m/s^2]

# The paper
A = np.array([0.0, 0.350, 1.200, 0.0, 0.0, 0.0])  # [m] a_{i-1}, Table 1
ALPHA = np.array([0, -90, 0, -90, 90, -90]) * DEG  # [rad] alpha_{i-1}, Table 1
D = np.array([0.683, 0.0, 0.0, -1.049, 0.0, 0.0])  # [m] d_i, Table 1
OFFSET = np.array([0, -90, 180, 0, 0, 0]) * DEG  # [rad] DH angle at the robot's zero, first bracket of Table 1
RANGE = np.array([[-185, 185], [-40, 110], [-190, 54], [-350, 350], [-120, 120], [-350, 350]]) * DEG  # [rad] Table 1
STIFFNESS = np.array([0.559, 1.435, 1.829, 0.184, 0.171, 0.070]) * 1e6  # [Nm/rad] Table 6, row "Current"
XI = np.array([169.6355, 220.8436, 220.8436, 127.0724, 138.3101, 139.4627])  # [Nm/A] Table 2
GAS_CONSTANT, CRITICAL_LENGTH = 4771.4, 0.9112  # C [Nm], l_c [m], Eq. (47)
DEAD_CENTRE = 3.3 * DEG  # [rad] theta_2 at which the balancing torque is zero, section 5
RATED_FORCE, RATED_MOMENT = 1500.0, 200.0  # [N], [Nm], worst case of section 4.2

# Reconstructed
CRANK, ANCHOR = 0.200, 0.700  # b = |axis 2 to B| and rho = sqrt(a^2 + h^2) = |axis 2 to A| [m], Eq. (9)
LOAD_POINT = np.array([0.1108, 0.0, -0.3587])  # [m] in frame 6, configuration set A1
REFERENCE_POINT = np.array([-0.3265, 0.2598, -0.6405])  # [m] in frame 6, configuration set A1

# Derived: A and B are in line with axis 2 at the dead centre, B at the lower end of the upper arm
ANCHOR_Y = -0.400  # [m] plane of the cylinder beside the arm, assumed; it changes neither l nor M
ANCHOR_A = np.array([A[1] - ANCHOR * np.sin(DEAD_CENTRE), ANCHOR_Y, -ANCHOR * np.cos(DEAD_CENTRE)])  # [m] on the column
ANCHOR_B = np.array([0.0, ANCHOR_Y, -CRANK])  # [m] on the upper arm


@dataclass(frozen=True)
class Part:
    """A rigid part: its mass and centre are reconstructed, the solid that gives its inertia is assumed.

    Attributes:
        name: Name of the body in hh150.xml.
        link: Link that carries it, 0 is the base.
        mass: [kg].
        com: Shape (3,) [m], centre of mass and of the solid, in the part's body frame.
        solid: [m], axes parallel to the body frame: box (x, y, z) or tube (outer, inner radius, length, axis 0 to 2).
        at: Shape (3,) [m], origin of the body frame in the frame of the link's body.
    """

    name: str
    link: int
    mass: float
    com: tuple[float, float, float]
    solid: tuple[float, ...]
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def inertia(self) -> Array:
        """Shape (3,) [kg m^2], principal moments about the centre of mass, in the axes of the body frame."""
        if len(self.solid) == 3:
            squares = np.square(self.solid)
            return self.mass / 12 * (squares.sum() - squares)
        outer, inner, length, axis = self.solid
        moments = np.full(3, self.mass / 12 * (3 * (outer**2 + inner**2) + length**2))
        moments[int(axis)] = self.mass / 2 * (outer**2 + inner**2)
        return moments


PARTS = (
    Part("base", 0, 250, (0, 0, 0.20), (0.33, 0.20, 0.40, 2)),
    Part("column", 1, 270, (0.10, 0, -0.08), (0.70, 0.55, 0.60)),
    Part("cylinder", 1, 85, (0.013, 0, 0.22), (0.075, 0.05, 0.45, 2), tuple(ANCHOR_A)),
    Part("upper_arm", 2, 160, (0, 0, 0.50), (0.26, 0.36, 1.30)),
    Part("forearm", 3, 110, (0.30, 0, 0), (0.80, 0.34, 0.34)),
    Part("forearm_tube", 4, 40, (-0.349, 0, 0), (0.15, 0.12, 0.60, 0)),
    Part("wrist", 5, 25, (0.05, 0, 0), (0.26, 0.26, 0.24)),
    Part("flange", 6, 8, (0, 0, -0.20), (0.10, 0.04, 0.05, 2)),
    Part("tool", 6, 40, (0, 0, -0.40), (0.50, 0.50, 0.45)),
)


def frames(q: Array) -> Array:
    """Return the link frames of Eq. (2) in the world, shape (6, 4, 4); q [rad] counts from the robot's zero."""
    pose, poses = np.eye(4), np.empty((6, 4, 4))
    for i, angle in enumerate(q + OFFSET):
        c, s = np.cos(angle), np.sin(angle)
        ca, sa = np.round([np.cos(ALPHA[i]), np.sin(ALPHA[i])])  # multiples of 90 deg
        step = [[c, -s, 0, A[i]], [s * ca, c * ca, -sa, -sa * D[i]], [s * sa, c * sa, ca, ca * D[i]], [0, 0, 0, 1]]
        pose = poses[i] = pose @ np.array(step)
    return poses


# The bodies of hh150.xml stand in the origins of Eq. (2) with world axes at zero; the last one has the axes of frame 6.
ZERO = frames(np.zeros(6))
BODY_AXES = np.concatenate([np.tile(np.eye(3), (5, 1, 1)), ZERO[5:, :3, :3]])


def orientation(poses: Array, link: int) -> Array:
    """Return the orientation (3, 3) of a link's body in the world, from the frames of the links."""
    return poses[link - 1, :3, :3] @ ZERO[link - 1, :3, :3].T @ BODY_AXES[link - 1]


def jacobian(poses: Array, link: int, point: Array) -> tuple[Array, Array]:
    """Return the world Jacobians, each (3, 6), of a point given in the frame of a link's body and of that frame.

    Args:
        poses: Frames of the links, from `frames`.
        link: 1 to 6.
        point: Shape (3,) [m].
    """
    axes, origins = poses[:link, :3, 2], poses[:, :3, 3]
    arms = orientation(poses, link) @ point + origins[link - 1] - origins[:link]
    linear, angular = np.zeros((3, 6)), np.zeros((3, 6))
    linear[:, :link], angular[:, :link] = np.cross(axes, arms).T, axes.T
    return linear, angular


def mass_matrix(q: Array, payload: float = 0.0) -> Array:
    """Return the mass matrix of the links, shape (6, 6) [kg m^2], with a point mass [kg] at the load point."""
    poses, matrix = frames(q), np.zeros((6, 6))
    for part in (*PARTS[1:], Part("payload", 6, payload, tuple(LOAD_POINT), (0, 0, 0))):
        linear, angular = jacobian(poses, part.link, np.add(part.at, part.com))
        turned = angular.T @ orientation(poses, part.link)
        matrix += part.mass * linear.T @ linear + turned * part.inertia @ turned.T
    return matrix


def gravity_torque(q: Array) -> Array:
    """Return the torque that holds the arm against gravity, without counterbalance, shape (6,) [Nm]."""
    poses = frames(q)
    lift = [part.mass * jacobian(poses, part.link, np.add(part.at, part.com))[0][2] for part in PARTS[1:]]
    return GRAVITY * np.sum(lift, axis=0)


def cylinder_length(theta_2: float) -> float:
    """Return l [m], Eq. (9); theta_2 counts from the robot's zero, in the paper alpha - theta_2 = 93.3 deg - this."""
    return float(np.sqrt(CRANK**2 + ANCHOR**2 - 2 * CRANK * ANCHOR * np.cos(theta_2 - DEAD_CENTRE)))


def balancing_torque(theta_2: float) -> float:
    """Return M [Nm], Eq. (11)."""
    length = cylinder_length(theta_2)
    return float(GAS_CONSTANT / length / (CRITICAL_LENGTH - length) * CRANK * ANCHOR * np.sin(theta_2 - DEAD_CENTRE))


def holding_torque(q: Array) -> Array:
    """Return the motor torque at rest without friction, shape (6,) [Nm]; Eq. (26) counts it the other way round."""
    torque = gravity_torque(q)
    torque[1] += balancing_torque(q[1])
    return torque
