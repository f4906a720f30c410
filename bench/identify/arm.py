"""The arm in Pinocchio, built from `RigidBodies`: pose, Jacobian, gravity, complementary stiffness."""

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from bench.errors import RobotError, unknown_name
from bench.robot.bodies import Array, Point, RigidBodies


class Arm:
    """Kinematics, statics and inverse dynamics of one arm.

    A *point* is the name of one of `bodies.points`, or a `Point`. Joint angles q have shape (..., n) [rad], and the
    leading dimensions return in the results. Everything is expressed in world axes; a wrench is (force, moment),
    applied at the point. Not safe to share between threads: Pinocchio computes in place.

    Attributes:
        bodies: The numbers it was built from.
    """

    def __init__(self, bodies: RigidBodies) -> None:
        self.bodies = bodies
        self._model = _pinocchio_model(bodies)
        self._data = self._model.createData()
        self._supports = _supports(bodies.parent)

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return self.bodies.n_joints

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints, base first."""
        return self.bodies.names

    def point(self, name: str | Point) -> Point:
        """Return a point by name.

        Raises:
            RobotError: No point has that name.
        """
        if isinstance(name, Point):
            return name
        if name not in self.bodies.points:
            raise RobotError(unknown_name("point of the arm", name, self.bodies.points))
        return self.bodies.points[name]

    def pose(self, q: Array, point: str | Point) -> tuple[Array, Array]:
        """Return position, shape (..., 3) [m], and orientation, shape (..., 3, 3), of a point."""
        point = self.point(point)
        _, origin, rotation = self._kinematics(q, point.body)
        return origin + rotation @ point.position, rotation @ point.rotation

    def jacobian(self, q: Array, point: str | Point) -> Array:
        """Return the Jacobian of a point, shape (..., 6, n): translation rows first, then rotation rows."""
        return self.position_and_jacobian(q, point)[1]

    def position_and_jacobian(self, q: Array, point: str | Point) -> tuple[Array, Array]:
        """Return position, shape (..., 3) [m], and Jacobian, shape (..., 6, n), of a point, in one pass."""
        point = self.point(point)
        spatial, origin, rotation = self._kinematics(q, point.body)
        position = origin + rotation @ point.position
        spatial = spatial * self._supports[point.body]
        moving, turning = spatial[..., :3, :], spatial[..., 3:, :]
        return position, np.concatenate([moving + np.cross(turning, position[..., None], axis=-2), turning], axis=-2)

    def hessian(self, q: Array, point: str | Point) -> Array:
        """Return the kinematic Hessian of a point, shape (..., 6, n, n).

        Its entry [:, i, j] is the derivative of Jacobian column i by q_j. With v and w the translation and rotation
        columns, a the one of joints i and j nearer to the base and b the other, dv_i/dq_j = w_a x v_b, and
        dw_i/dq_j = w_j x w_i where j is nearer to the base than i, else 0.
        """
        return _hessian(self.jacobian(q, point))

    def complementary_stiffness(self, q: Array, point: str | Point, wrench: Array) -> Array:
        """Return K_C, Eq. (18), shape (..., n, n) [Nm/rad], for a wrench of shape (..., 6) [N, Nm] at a point."""
        return complementary_stiffness(self.jacobian(q, point), wrench)

    def gravity(self, q: Array) -> Array:
        """Return the joint torque that holds the links against gravity, G of Eq. (26), shape (..., n) [Nm]."""
        flat = q.reshape(-1, self.n_joints)
        rows = [pin.computeGeneralizedGravity(self._model, self._data, row).copy() for row in flat]
        return np.array(rows).reshape(q.shape)

    def gravity_stiffness(self, q: Array) -> Array:
        """Return dG/dtheta, shape (..., n, n) [Nm/rad]."""
        flat = q.reshape(-1, self.n_joints)
        rows = [pin.computeGeneralizedGravityDerivatives(self._model, self._data, row).copy() for row in flat]
        return np.array(rows).reshape(*q.shape, self.n_joints)

    def mass_matrix(self, q: Array) -> Array:
        """Return the inertia matrix D of Eq. (29), links only, shape (n, n) [kg m^2]."""
        upper = np.triu(pin.crba(self._model, self._data, q))
        return np.array(upper + np.triu(upper, 1).T)

    def inverse_dynamics(self, q: Array, velocity: Array, acceleration: Array) -> Array:
        """Return D a + C(q, v) + G of Eq. (29), shape (n,) [Nm]: the torque on the links that makes this motion."""
        return np.array(pin.rnea(self._model, self._data, q, velocity, acceleration))

    def torque_regressor(self, q: Array, velocity: Array, acceleration: Array) -> Array:
        """Return Y with `inverse_dynamics` = Y pi, shape (n, 10 n).

        pi holds for each link m, m c, and the inertia about the joint frame's origin (xx, xy, yy, xz, yz, zz).
        """
        return np.array(pin.computeJointTorqueRegressor(self._model, self._data, q, velocity, acceleration))

    def _kinematics(self, q: Array, body: int) -> tuple[Array, Array, Array]:
        """Return the Jacobian at the world's origin, (..., 6, n), and a body's origin (..., 3) and axes (..., 3, 3)."""
        flat = q.reshape(-1, self.n_joints)
        spatial = np.empty((len(flat), 6, self.n_joints))
        origin, rotation = np.empty((len(flat), 3)), np.empty((len(flat), 3, 3))
        for i, row in enumerate(flat):
            spatial[i] = pin.computeJointJacobians(self._model, self._data, row).reshape(6, -1)  # (6,) of one joint
            placement = self._data.oMi[body + 1]
            origin[i], rotation[i] = placement.translation, placement.rotation
        lead = q.shape[:-1]
        return spatial.reshape(*lead, 6, self.n_joints), origin.reshape(*lead, 3), rotation.reshape(*lead, 3, 3)


def complementary_stiffness(jacobian: Array, wrench: Array) -> Array:
    """Return K_C = [d(J_f^T)/dtheta_j W], Eq. (18), shape (..., n, n) [Nm/rad].

    Args:
        jacobian: Shape (..., 6, n), J_f.
        wrench: Shape (..., 6) [N, Nm].
    """
    return np.array(np.einsum("...kij,...k->...ij", _hessian(jacobian), wrench))


def _hessian(jacobian: Array) -> Array:
    v, w = jacobian[..., :3, :], jacobian[..., 3:, :]
    index = np.arange(jacobian.shape[-1])
    near, far = np.minimum.outer(index, index), np.maximum.outer(index, index)
    translation = np.cross(w[..., near], v[..., far], axis=-3)
    rotation = np.cross(w[..., None, :], w[..., :, None], axis=-3) * (index[None, :] < index[:, None])
    return np.concatenate([translation, rotation], axis=-3)


def _pinocchio_model(bodies: RigidBodies) -> pin.Model:
    model = pin.Model()
    model.gravity = pin.Motion(np.array(bodies.gravity), np.zeros(3))
    for i, name in enumerate(bodies.names):
        axis = np.array(bodies.axis[i])
        joint = pin.JointModelRevoluteUnaligned(axis) if bodies.is_hinge[i] else pin.JointModelPrismaticUnaligned(axis)
        placement = pin.SE3(np.array(bodies.rotation[i]), np.array(bodies.position[i]))
        number = model.addJoint(int(bodies.parent[i]) + 1, joint, placement, name)
        if number != i + 1:
            raise RobotError(f"joint {name!r} is out of order: list the joints from the base to the tool.")
        inertia = pin.Inertia(float(bodies.mass[i]), np.array(bodies.com[i]), np.array(bodies.inertia[i]))
        model.appendBodyToJoint(number, inertia, pin.SE3.Identity())
    return model


def _supports(parent: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return which joints move a body, shape (n + 1, n); the last row is the base, body -1."""
    n = len(parent)
    moves = np.zeros((n + 1, n), dtype=np.bool_)
    for i in range(n):
        moves[i] = moves[parent[i]]
        moves[i, i] = True
    return moves
