"""Springs and cylinders of somebody's file that hold gravity: they are left out, and where to put them back is said."""

from collections.abc import Iterator, Sequence

import mujoco
import numpy as np

from bench.robot.bodies import Array

POSES = 200  # spread over the working range, as many as masses are looked at in (`defaults.py`)
PUT_BACK = (
    'put it back as a spatial tendon with <plugin plugin="bench.gas_spring"> in the new MJCF and `counterbalance` in '
    "figures.yaml (models/own-robot.md)"
)


def lost_balance(model: mujoco.MjModel, driven: Sequence[int], names: Sequence[str]) -> Iterator[str]:
    """Yield a sentence for each driven joint whose gravity something holds that will be left out.

    What pushes with the torque of gravity is told from what does not by the sum of squares over poses of the working
    range: with it the drive has to hold less.

    Args:
        model: Of the file, with everything in it.
        driven: Indices of the driven joints.
        names: Theirs.
    """
    low, high = np.where(model.jnt_limited[driven], model.jnt_range[driven].T, [[-np.pi], [np.pi]])
    low, high = np.clip(low, -np.pi, np.pi), np.clip(high, -np.pi, np.pi)
    poses = np.random.default_rng(1).uniform(low, high, size=(POSES, len(driven)))
    dof, address = model.jnt_dofadr[driven], model.jnt_qposadr[driven]
    gravity, of_joints, of_tendons = np.zeros((3, POSES, len(driven)))
    data = mujoco.MjData(model)
    for k, pose in enumerate(poses):
        data.qpos[address] = pose
        mujoco.mj_forward(model, data)
        gravity[k] = data.qfrc_bias[dof]
        of_tendons[k] = data.qfrc_spring[dof] + _pulled(model, data)[dof]
    joints_alone = _without_tendons(model)
    for k, pose in enumerate(poses):
        data.qpos[address] = pose
        mujoco.mj_forward(joints_alone, data)
        of_joints[k] = data.qfrc_spring[dof]
    of_tendons -= of_joints
    for j, name in enumerate(names):
        for torque, what in ((of_joints, "the spring of the joint"), (of_tendons, _tendons(model))):
            left = gravity[:, j] - torque[:, j]
            if np.any(torque[:, j]) and np.sum(left**2) < np.sum(gravity[:, j] ** 2):
                most, before = np.max(np.abs(torque[:, j])), np.max(np.abs(gravity[:, j]))
                unit = "N" if model.jnt_type[driven[j]] == mujoco.mjtJoint.mjJNT_SLIDE else "Nm"
                yield (
                    f"gravity of {name} is no longer held by {what}, which was left out: up to {most:.3g} {unit} where "
                    f"the links need up to {before:.3g}; {PUT_BACK}"
                )


def _pulled(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    """Return the generalised force of the actuators that pull at tendons, as they pull by themselves (controls 0)."""
    on_tendon = model.actuator_trntype == mujoco.mjtTrn.mjTRN_TENDON
    moment = np.zeros((len(on_tendon), model.nv))  # an actuator may have several controls, and `nu` counts those
    if len(on_tendon):
        mujoco.mju_sparse2dense(
            moment, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind
        )
    found: Array = np.where(on_tendon, data.actuator_force, 0.0) @ moment
    return found


def _without_tendons(model: mujoco.MjModel) -> mujoco.MjModel:
    """Return a copy of a model whose tendons have no springs."""
    slack = mujoco.MjModel.__copy__(model)
    slack.tendon_stiffness[:] = 0
    slack.tendon_stiffnesspoly[:] = 0
    return slack


def _tendons(model: mujoco.MjModel) -> str:
    """Return which tendons pull by a spring or an actuator, in words."""
    by_actuator = model.actuator_trnid[model.actuator_trntype == mujoco.mjtTrn.mjTRN_TENDON, 0]
    pull = [t for t in range(model.ntendon) if model.tendon_stiffness[t] > 0 or t in by_actuator]
    return f"tendon {' and '.join(repr(model.tendon(t).name or f'number {t}') for t in pull)}"
