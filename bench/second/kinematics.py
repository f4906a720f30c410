"""Where the links are, and what gravity and loads ask of their joints, over T instants at once; own inertia apart."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from bench.second.figures import Array, Figures, Spot


@dataclass(frozen=True, eq=False)
class Frames:
    """Joint frames in the base frame: origins, shape (T, n, 3) [m], and axes, shape (T, n, 3, 3)."""

    origin: Array
    axes: Array

    def point(self, spot: Spot) -> Array:
        """Return where a point is, shape (T, 3) [m]."""
        return self.origin[:, spot.joint] + self.axes[:, spot.joint] @ spot.position


def frames(figures: Figures, theta: Array) -> Frames:
    """Return the joint frames at link angles of shape (T, n) [rad]."""
    origin, axes = np.zeros((*theta.shape, 3)), np.zeros((*theta.shape, 3, 3))
    for j in range(figures.n):
        up = int(figures.parent[j])
        base = np.zeros(3) if up < 0 else origin[:, up]
        turn = np.eye(3) if up < 0 else axes[:, up]
        origin[:, j] = base + turn @ figures.position[j]
        axes[:, j] = turn @ figures.rotation[j] @ _turns(figures.axis[j], theta[:, j])
    return Frames(origin, axes)


def _turns(axis: Array, angle: Array) -> Array:
    """Return rotations about an axis, shape (T, 3, 3), by Rodrigues' formula."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    bend = (1 - np.cos(angle))[:, None, None] * (cross @ cross)
    turns: Array = np.eye(3) + np.sin(angle)[:, None, None] * cross + bend
    return turns


def leaned_gravity(figures: Figures, lean: Array) -> Array:
    """Return gravity in the axes of a base that leans by rotation vectors, shape (T, 3) [rad], to first order."""
    return figures.gravity - np.cross(lean, figures.gravity)


def asked_of_joints(figures: Figures, at: Frames, gravity: Array, wrench: Array) -> Array:
    """Return the torque that holds the links against gravity and load, shape (T, n) [Nm].

    Args:
        figures: The arm, payload included.
        at: Its frames.
        gravity: Shape (T, 3) [m/s^2].
        wrench: Shape (T, 6) [N, Nm], force and moment on the load point, in the axes of the base.
    """
    n = figures.n
    force, moment = np.zeros_like(at.origin), np.zeros_like(at.origin)  # on each link, moments about the base's origin
    for lump in figures.lumps:
        weight = lump.mass * gravity
        place = at.origin[:, lump.joint] + at.axes[:, lump.joint] @ lump.com
        force[:, lump.joint] += weight
        moment[:, lump.joint] += np.cross(place, weight)
    hook = at.point(figures.load)
    force[:, figures.load.joint] += wrench[:, :3]
    moment[:, figures.load.joint] += wrench[:, 3:] + np.cross(hook, wrench[:, :3])
    asked = np.zeros(at.origin.shape[:2])
    for j in reversed(range(n)):
        hinge = at.axes[:, j] @ figures.axis[j]
        about = moment[:, j] - np.cross(at.origin[:, j], force[:, j])
        asked[:, j] = -np.einsum("tk,tk->t", hinge, about)
        up = int(figures.parent[j])
        if up >= 0:
            force[:, up] += force[:, j]
            moment[:, up] += moment[:, j]
    return asked


def moment_on_base(figures: Figures, at: Frames, wrench: Array) -> Array:
    """Return the moment of all weights and of the load about the foot, shape (T, 3) [Nm]."""
    moment = np.zeros((len(wrench), 3))
    for lump in figures.lumps:
        place = at.origin[:, lump.joint] + at.axes[:, lump.joint] @ lump.com
        moment += np.cross(place, lump.mass * figures.gravity)
    return moment + wrench[:, 3:] + np.cross(at.point(figures.load), wrench[:, :3])


def inertia_torque(figures: Figures, q: Array, velocity: Array, acceleration: Array) -> tuple[Array, Array]:
    """Return what accelerating the links takes of the drives, without gravity, and how they push the foot meanwhile.

    By Pinocchio, where they move: torques, shape (T, n) [Nm], and moments about the foot, shape (T, 3) [Nm].
    """
    model = pin.Model()
    model.gravity = pin.Motion.Zero()
    for j in range(figures.n):
        joint = pin.JointModelRevoluteUnaligned(np.array(figures.axis[j]))
        placement = pin.SE3(np.array(figures.rotation[j]), np.array(figures.position[j]))
        model.addJoint(int(figures.parent[j]) + 1, joint, placement, f"joint{j}")
    for lump in figures.lumps:
        inertia = pin.Inertia(lump.mass, np.array(lump.com), np.array(lump.inertia))
        model.appendBodyToJoint(lump.joint + 1, inertia, pin.SE3.Identity())
    data = model.createData()
    torque, moment = np.zeros_like(q), np.zeros((len(q), 3))
    for t in np.flatnonzero(np.any(velocity != 0, axis=1) | np.any(acceleration != 0, axis=1)):
        torque[t] = pin.rnea(model, data, q[t], velocity[t], acceleration[t])
        moment[t] = -sum(data.liMi[i].act(data.f[i]).angular for i in range(1, model.njoints) if not model.parents[i])
    return torque, moment
