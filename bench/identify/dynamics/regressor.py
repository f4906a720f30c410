"""The joint torque of rigid links as a linear function of their inertial parameters (Pinocchio)."""

from dataclasses import replace

import numpy as np
import pinocchio as pin

from bench.identify.arm import Arm
from bench.record.campaign import Array
from bench.robot.bodies import RigidBodies, read_only

N_INERTIAL = 10  # exact: m, m c (3), and the inertia about the joint frame's origin: xx, xy, yy, xz, yz, zz
NAMES = ("m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
NOT_NEGATIVE = [0, 4, 6, 9]  # exact: of these, mass and inertia about each axis
TINY = 1e-12  # rounding: [kg m^2]; constraints let bodies be thinner than that
UNITS = ("kg", "kg m", "kg m", "kg m", *("kg m^2",) * 6)


def standard_parameters(bodies: RigidBodies) -> Array:
    """Return the inertial parameters of all links in Pinocchio's order, shape (10 n,); `NAMES` and `UNITS`."""
    links = zip(bodies.mass, bodies.com, bodies.inertia, strict=True)
    inertias = (pin.Inertia(float(m), np.array(c), np.array(i)) for m, c, i in links)
    return np.concatenate([inertia.toDynamicParameters() for inertia in inertias]).reshape(N_INERTIAL * bodies.n_joints)


def links_with(bodies: RigidBodies, parameters: Array) -> RigidBodies:
    """Return links with other inertial parameters, shape (n, 10), of bodies that can exist."""
    mass, first, about = parameters[:, 0], parameters[:, 1:4], parameters[:, 4:]
    safe = np.where(mass > 0, mass, 1.0)
    com = np.where(mass[:, None] > 0, first / safe[:, None], 0.0)
    inertia = about[:, [[0, 1, 3], [1, 2, 4], [3, 4, 5]]]
    squares = np.sum(com**2, axis=1)[:, None, None] * np.eye(3) - com[:, :, None] * com[:, None, :]
    values, vectors = np.linalg.eigh(inertia - mass[:, None, None] * squares)
    inertia = np.einsum("nij,nj,nkj->nik", vectors, np.maximum(values, TINY), vectors)
    return replace(bodies, mass=read_only(mass), com=read_only(com), inertia=read_only(inertia))


def link_regressor(arm: Arm, position: Array, velocity: Array, acceleration: Array) -> Array:
    """Return Y with tau = Y pi, shape (T, n, 10 n): inverse dynamics D a + C(q, v) v + G of the links.

    Args:
        arm: Kinematics; its masses do not enter.
        position: Shape (T, n) [rad].
        velocity: Shape (T, n) [rad/s].
        acceleration: Shape (T, n) [rad/s^2].
    """
    n = arm.n_joints
    found = np.empty((len(position), n, N_INERTIAL * n))
    for i, state in enumerate(zip(position, velocity, acceleration, strict=True)):
        found[i] = arm.torque_regressor(*state)
    return found


def payload_columns(arm: Arm, load_point: str) -> tuple[int, Array]:
    """Return the link that carries the load point, and what a payload adds to its parameters, shape (10, 10).

    The payload's parameters are those of a body in the axes of its link whose frame sits in the load point.
    """
    point = arm.point(load_point)
    return point.body, _moved(np.eye(N_INERTIAL), point.position)


def _moved(parameters: Array, offset: Array) -> Array:
    """Return parameters, shape (10, k), about an origin `offset` away, shape (3,): m, h + m o, I + Steiner terms."""
    mass, first = parameters[0], parameters[1:4]
    both = first[:, None] * offset[None, :, None]
    cross = both + np.swapaxes(both, 0, 1) + mass * np.outer(offset, offset)[:, :, None]
    steiner = np.trace(cross) * np.eye(3)[:, :, None] - cross
    moved = first + mass * offset[:, None]
    return np.concatenate([mass[None], moved, parameters[4:] + steiner[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]])
