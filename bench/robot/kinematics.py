"""Where a point of the arm is, and how it moves with the joints: forward kinematics of `RigidBodies` in plain numpy.

For planning, where neither engine may be asked. Identification has the same from Pinocchio (`bench.identify.arm`), the
simulation from MuJoCo; a test holds the three together.
"""

from dataclasses import dataclass

import numpy as np

from bench.robot.bodies import Array, Point, RigidBodies

PARALLEL = 1e-12  # sine of an angle below which two directions count as parallel


@dataclass(frozen=True)
class Placement:
    """Where a point is.

    Attributes:
        position: Shape (3,) [m], world axes.
        rotation: Shape (3, 3), from the axes of the point to those of the world.
    """

    position: Array
    rotation: Array


def place(bodies: RigidBodies, point: Point, q: Array) -> Placement:
    """Return where a point is at joint angles q, shape (n,) [rad]."""
    return place_and_jacobian(bodies, point, q)[0]


def place_and_jacobian(bodies: RigidBodies, point: Point, q: Array) -> tuple[Placement, Array]:
    """Return where a point is at q, shape (n,) [rad], and its Jacobian, shape (6, n), translation first."""
    chain = [point.body] if point.body >= 0 else []
    while chain and bodies.parent[chain[-1]] >= 0:
        chain.append(int(bodies.parent[chain[-1]]))
    origin, rotation = np.zeros(3), np.eye(3)
    axes: dict[int, tuple[Array, Array]] = {}  # joint -> its axis and a point on it, world axes
    for joint in reversed(chain):
        origin = origin + rotation @ bodies.position[joint]
        rotation = rotation @ bodies.rotation[joint]
        axis = rotation @ bodies.axis[joint]
        axes[joint] = axis, origin
        if bodies.is_hinge[joint]:
            rotation = rotation @ turned(bodies.axis[joint], q[joint])
        else:
            origin = origin + q[joint] * axis
    position = origin + rotation @ point.position
    jacobian = np.zeros((6, bodies.n_joints))
    for joint, (axis, foot) in axes.items():
        if bodies.is_hinge[joint]:
            jacobian[:3, joint], jacobian[3:, joint] = np.cross(axis, position - foot), axis
        else:
            jacobian[:3, joint] = axis
    return Placement(position, rotation @ point.rotation), jacobian


def turned(axis: Array, angle: float) -> Array:
    """Return the rotation by an angle [rad] about a unit vector, shape (3, 3); Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


def turn_onto(first: Array, second: Array) -> Array:
    """Return the smallest rotation that brings one direction onto another, shape (3, 3); any length, not zero."""
    a, b = first / np.linalg.norm(first), second / np.linalg.norm(second)
    axis, cosine = np.cross(a, b), float(a @ b)
    sine = float(np.linalg.norm(axis))
    if sine < PARALLEL:
        if cosine > 0:
            return np.eye(3)
        axis = np.cross(a, np.eye(3)[np.argmin(np.abs(a))])  # half a turn, about any direction across
        sine = float(np.linalg.norm(axis))
        return turned(axis / sine, np.pi)
    return turned(axis / sine, float(np.arctan2(sine, cosine)))


def rotation_vector(rotation: Array) -> Array:
    """Return the rotation vector of a rotation matrix, shape (3,) [rad]; the angle is below pi."""
    twice_sine = np.array(
        [rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]]
    )
    size = float(np.linalg.norm(twice_sine))
    angle = float(np.arctan2(size, np.trace(rotation) - 1))
    return twice_sine / 2 if size < PARALLEL else angle / size * twice_sine
