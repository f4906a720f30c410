"""From a compiled model to its links as plain numbers."""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.errors import RobotError
from bench.robot.bodies import Point, RigidBodies, read_only
from bench.robot.compiled import CompiledRobot


@dataclass(frozen=True, eq=False)
class Poses:
    """Where bodies are, all joints at zero; n links, m bodies of the model.

    Attributes:
        carrier: Shape (m,), link that carries each body; -1 of what stands on the ground.
        position, rotation: Shape (m, 3) [m] and (m, 3, 3), in the joint frame of that link.
        parent: Shape (n,), link that carries each link; -1: none.
        placement, orientation: Shape (n, 3) [m] and (n, 3, 3), of each link's joint frame in that of its parent.
    """

    carrier: NDArray[np.int64]
    position: NDArray[np.float64]
    rotation: NDArray[np.float64]
    parent: NDArray[np.int64]
    placement: NDArray[np.float64]
    orientation: NDArray[np.float64]


def poses_of(compiled: CompiledRobot) -> Poses:
    """Return where bodies are; a jointless body or a rotor counts to the link that carries it.

    So does a body on a spring that nothing drives, such as a base that rocks: it stands where its spring is at rest.

    Raises:
        RobotError: A link moves by more than one joint or by one that neither a drive nor a spring holds, or a joint
            has a `ref`.
    """
    model, at = compiled.model, compiled.at
    joint_of_body = {int(model.jnt_bodyid[j]): i for i, j in enumerate(at.joint)}
    rotor_bodies = {int(model.dof_bodyid[dof]) for dof in at.q_dof}
    n = compiled.n_joints
    if len(joint_of_body) < n:
        raise RobotError(f"{compiled.robot.mjcf}: two driven joints share a body; give each joint a body of its own.")

    if np.any(model.qpos0[at.theta]):
        raise RobotError(f"{compiled.robot.mjcf}: a driven joint has ref != 0; move its zero into the body's pose.")

    carrier = np.full(model.nbody, -1)
    position = np.zeros((model.nbody, 3))
    rotation = np.tile(np.eye(3), (model.nbody, 1, 1))
    parent = np.full(n, -1)
    placement = np.zeros((n, 3))
    orientation = np.zeros((n, 3, 3))
    parents, places, joints = model.body_parentid.tolist(), model.body_pos, model.body_jntnum.tolist()
    turns = [_matrix(quaternion) for quaternion in model.body_quat]
    for body in range(1, model.nbody):
        above = parents[body]
        origin = position[above] + rotation[above] @ places[body]
        turned = rotation[above] @ turns[body]
        if body in joint_of_body:
            i = joint_of_body[body]
            pivot = model.jnt_pos[at.joint[i]]
            parent[i] = carrier[above]
            placement[i] = origin + turned @ pivot
            orientation[i] = turned
            carrier[body], position[body], rotation[body] = i, -pivot, np.eye(3)
        elif joints[body] and body not in rotor_bodies and not _is_sprung(model, body):
            name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body)
            raise RobotError(f"{compiled.robot.mjcf}: body {name!r} has a joint that no drive of figures.yaml names.")
        else:
            carrier[body], position[body], rotation[body] = carrier[above], origin, turned
    if np.any(parent >= np.arange(n)):
        raise RobotError(f"{compiled.robot.figures_file}: drives: list them from the base to the tool.")
    return Poses(carrier, position, rotation, parent, placement, orientation)


def inertial_parameters(compiled: CompiledRobot, poses: Poses) -> NDArray[np.float64]:
    """Return m, m c (3), and inertia about the joint frame (xx, xy, yy, xz, yz, zz) of each link, shape (10 n,)."""
    mass, moment, about_origin = _inertia_of(compiled, poses)
    return np.concatenate([mass[:, None], moment, about_origin[:, *np.tril_indices(3)]], axis=1).ravel()


def _inertia_of(
    compiled: CompiledRobot, poses: Poses
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return masses, first moments and inertias of links about their joint frames, shapes (n,), (n, 3), (n, 3, 3)."""
    model, n = compiled.model, compiled.n_joints
    carried = np.flatnonzero(poses.carrier >= 0)
    of, masses, turned_to = poses.carrier[carried], model.body_mass[carried], poses.rotation[carried]
    centre = poses.position[carried] + np.einsum("bij,bj->bi", turned_to, model.body_ipos[carried])
    axes = turned_to @ np.stack([_matrix(quaternion) for quaternion in model.body_iquat[carried]])
    about_centre = np.einsum("bij,bj,bkj->bik", axes, model.body_inertia[carried], axes)
    mass, moment, about_origin = np.zeros(n), np.zeros((n, 3)), np.zeros((n, 3, 3))
    np.add.at(mass, of, masses)
    np.add.at(moment, of, masses[:, None] * centre)
    np.add.at(about_origin, of, about_centre + _of_points(masses, centre))
    return mass, moment, about_origin


def rigid_bodies(compiled: CompiledRobot) -> RigidBodies:
    """Return the links of the arm as plain numbers.

    Raises:
        RobotError: As `poses_of`.
    """
    model, at, poses = compiled.model, compiled.at, poses_of(compiled)
    mass, moment, about_origin = _inertia_of(compiled, poses)
    com = moment / mass[:, None]
    inertia = about_origin - _of_points(mass, com)

    points = {}
    for site, (body, place, quaternion) in enumerate(
        zip(model.site_bodyid.tolist(), model.site_pos, model.site_quat, strict=True)
    ):
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_SITE, site)
        if name:
            where = poses.position[body] + poses.rotation[body] @ place
            turned = poses.rotation[body] @ _matrix(quaternion)
            points[name] = Point(int(poses.carrier[body]), read_only(where), read_only(turned))
    return RigidBodies(
        names=tuple(drive.joint for drive in compiled.robot.figures.drives),
        parent=poses.parent,
        is_hinge=np.asarray(model.jnt_type[at.joint] == mujoco.mjtJoint.mjJNT_HINGE),
        position=read_only(poses.placement),
        rotation=read_only(poses.orientation),
        axis=read_only(model.jnt_axis[at.joint]),
        mass=read_only(mass),
        com=read_only(com),
        inertia=read_only(inertia),
        limits=read_only(compiled.limits),
        gravity=read_only(model.opt.gravity),
        points=points,
    )


def _is_sprung(model: mujoco.MjModel, body: int) -> bool:
    first = model.body_jntadr[body]
    joints = range(first, first + model.body_jntnum[body])
    return all(np.ravel(model.jnt_stiffness[joint])[0] > 0 for joint in joints)


def _matrix(quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, quaternion)
    return matrix.reshape(3, 3)


def _of_points(mass: NDArray[np.float64], offset: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the inertia of point masses, shape (b,), at offsets, shape (b, 3), about the origin: shape (b, 3, 3)."""
    squares = np.sum(offset**2, axis=1)[:, None, None] * np.eye(3)
    return np.asarray(mass[:, None, None] * (squares - offset[:, :, None] * offset[:, None, :]))
