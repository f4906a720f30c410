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
    for body in range(1, model.nbody):
        above = int(model.body_parentid[body])
        local = _matrix(model.body_quat[body])
        origin = position[above] + rotation[above] @ model.body_pos[body]
        turned = rotation[above] @ local
        if body in joint_of_body:
            i = joint_of_body[body]
            pivot = model.jnt_pos[at.joint[i]]
            parent[i] = carrier[above]
            placement[i] = origin + turned @ pivot
            orientation[i] = turned
            carrier[body], position[body], rotation[body] = i, -pivot, np.eye(3)
        elif model.body_jntnum[body] and body not in rotor_bodies and not _is_sprung(model, body):
            name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, body)
            raise RobotError(f"{compiled.robot.mjcf}: body {name!r} has a joint that no drive of figures.yaml names.")
        else:
            carrier[body], position[body], rotation[body] = carrier[above], origin, turned
    if np.any(parent >= np.arange(n)):
        raise RobotError(f"{compiled.robot.figures_file}: drives: list them from the base to the tool.")

    mass = np.zeros(n)
    moment = np.zeros((n, 3))
    spread = np.zeros((n, 3, 3))  # second moments about the joint frame's origin, kept as inertia tensors
    for body in range(1, model.nbody):
        i = carrier[body]
        if i < 0:
            continue
        com = position[body] + rotation[body] @ model.body_ipos[body]
        axes = rotation[body] @ _matrix(model.body_iquat[body])
        mass[i] += model.body_mass[body]
        moment[i] += model.body_mass[body] * com
        spread[i] += axes @ np.diag(model.body_inertia[body]) @ axes.T + _steiner(model.body_mass[body], com)
    com = moment / mass[:, None]
    inertia = np.stack([spread[i] - _steiner(mass[i], com[i]) for i in range(n)])

    points = {}
    for site in range(model.nsite):
        body = int(model.site_bodyid[site])
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_SITE, site)
        if name:
            where = position[body] + rotation[body] @ model.site_pos[site]
            points[name] = Point(
                int(carrier[body]), read_only(where), read_only(rotation[body] @ _matrix(model.site_quat[site]))
            )
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


def _steiner(mass: float, offset: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the inertia of a point mass at `offset` about the origin."""
    return mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
