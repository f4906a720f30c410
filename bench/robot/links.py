"""From a compiled model to its links as plain numbers."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.errors import RobotError
from bench.robot.bodies import Point, RigidBodies, read_only
from bench.robot.compiled import CompiledRobot


def rigid_bodies(compiled: CompiledRobot) -> RigidBodies:
    """Return the links of the arm as plain numbers; a jointless body or a rotor counts to the link that carries it.

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

    # Pose of every MuJoCo body in the joint frame of the arm's body that carries it, all joints at zero.
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

    carried = np.flatnonzero(carrier >= 0)
    of, masses, turned_to = carrier[carried], model.body_mass[carried], rotation[carried]
    centre = position[carried] + np.einsum("bij,bj->bi", turned_to, model.body_ipos[carried])
    axes = turned_to @ np.stack([_matrix(quaternion) for quaternion in model.body_iquat[carried]])
    about_centre = np.einsum("bij,bj,bkj->bik", axes, model.body_inertia[carried], axes)
    mass, moment, about_origin = np.zeros(n), np.zeros((n, 3)), np.zeros((n, 3, 3))
    np.add.at(mass, of, masses)
    np.add.at(moment, of, masses[:, None] * centre)
    np.add.at(about_origin, of, about_centre + _of_points(masses, centre))
    com = moment / mass[:, None]
    inertia = about_origin - _of_points(mass, com)

    points = {}
    for site, (body, place, quaternion) in enumerate(
        zip(model.site_bodyid.tolist(), model.site_pos, model.site_quat, strict=True)
    ):
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_SITE, site)
        if name:
            where = position[body] + rotation[body] @ place
            turned = rotation[body] @ _matrix(quaternion)
            points[name] = Point(int(carrier[body]), read_only(where), read_only(turned))
    return RigidBodies(
        names=tuple(drive.joint for drive in compiled.robot.figures.drives),
        parent=parent,
        is_hinge=np.asarray(model.jnt_type[at.joint] == mujoco.mjtJoint.mjJNT_HINGE),
        position=read_only(placement),
        rotation=read_only(orientation),
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
