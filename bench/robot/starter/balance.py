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
    tendons = _pulling(model)
    gravity, of_joints = np.zeros((2, POSES, len(driven)))
    of_tendons = np.zeros((len(tendons), POSES, len(driven)))
    data = mujoco.MjData(model)
    joints_alone = _slack(model)
    for k, pose in enumerate(poses):
        data.qpos[address] = pose
        mujoco.mj_forward(model, data)
        gravity[k] = data.qfrc_bias[dof]
        for i, tendon in enumerate(tendons):
            of_tendons[i, k] = _pulled(model, data, tendon)[dof]
        mujoco.mj_forward(joints_alone, data)
        of_joints[k] = data.qfrc_spring[dof]
    for i, tendon in enumerate(tendons):  # each by itself: an elastic element between drive and joint holds nothing up
        alone = _slack(model, tendon)
        for k, pose in enumerate(poses):
            data.qpos[address] = pose
            mujoco.mj_forward(alone, data)
            of_tendons[i, k] += data.qfrc_spring[dof] - of_joints[k]
    holding = [("the spring of the joint", of_joints)]
    holding += [(_named(model, tendon), torque) for tendon, torque in zip(tendons, of_tendons, strict=True)]
    for j, name in enumerate(names):
        for what, torque in holding:
            left = gravity[:, j] - torque[:, j]
            if np.any(torque[:, j]) and np.sum(left**2) < np.sum(gravity[:, j] ** 2):
                most, before = np.max(np.abs(torque[:, j])), np.max(np.abs(gravity[:, j]))
                unit = "N" if model.jnt_type[driven[j]] == mujoco.mjtJoint.mjJNT_SLIDE else "Nm"
                yield (
                    f"gravity of {name} is no longer held by {what}, which was left out: up to {most:.3g} {unit} where "
                    f"the links need up to {before:.3g}; {PUT_BACK}"
                )


def _pulling(model: mujoco.MjModel) -> list[int]:
    """Return the tendons that pull by a spring or an actuator."""
    by_actuator = model.actuator_trnid[model.actuator_trntype == mujoco.mjtTrn.mjTRN_TENDON, 0]
    return [t for t in range(model.ntendon) if model.tendon_stiffness[t] > 0 or t in by_actuator]


def _pulled(model: mujoco.MjModel, data: mujoco.MjData, tendon: int) -> Array:
    """Return the generalised force of the actuators that pull at a tendon, as they pull by themselves (controls 0)."""
    on_tendon = (model.actuator_trntype == mujoco.mjtTrn.mjTRN_TENDON) & (model.actuator_trnid[:, 0] == tendon)
    moment = np.zeros((len(on_tendon), model.nv))  # an actuator may have several controls, and `nu` counts those
    if len(on_tendon):
        mujoco.mju_sparse2dense(
            moment, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind
        )
    found: Array = np.where(on_tendon, data.actuator_force, 0.0) @ moment
    return found


def _slack(model: mujoco.MjModel, but: int | None = None) -> mujoco.MjModel:
    """Return a copy of a model whose tendons have no springs, but for one."""
    slack = mujoco.MjModel.__copy__(model)
    others = np.arange(model.ntendon) != but
    slack.tendon_stiffness[others] = 0
    slack.tendon_stiffnesspoly[others] = 0
    return slack


def _named(model: mujoco.MjModel, tendon: int) -> str:
    return f"tendon {model.tendon(tendon).name or f'number {tendon}'!r}"
