"""What the actuators of somebody's file say of the drives."""

from collections.abc import Iterator

import mujoco
import numpy as np


def torque_limit(model: mujoco.MjModel, j: int) -> float:
    """Return the largest torque of a joint's actuator, or of the joint itself; 0 if nothing limits it."""
    limits = [float(np.max(np.abs(model.jnt_actfrcrange[j])))] if model.jnt_actfrclimited[j] else []
    for actuator in _actuators_of(model, j):
        gear = abs(float(model.actuator_gear[actuator, 0]))
        if model.actuator_forcelimited[actuator]:
            limits.append(gear * float(np.max(np.abs(model.actuator_forcerange[actuator]))))
        elif int(model.actuator_biastype[actuator]) == int(mujoco.mjtBias.mjBIAS_NONE):
            control = model.actuator_ctrladr[actuator]
            if model.actuator_ctrllimited[actuator]:
                gain = abs(float(model.actuator_gainprm[actuator, 0]))
                limits.append(gear * gain * float(np.max(np.abs(model.actuator_ctrlrange[control]))))
    return min(limits, default=0.0)


def one_sided(model: mujoco.MjModel, j: int, name: str) -> Iterator[str]:
    """Yield a sentence for each torque limit of a joint between whose ends zero does not lie; drives pull both ways."""
    limits = [("actfrcrange", model.jnt_actfrcrange[j])] if model.jnt_actfrclimited[j] else []
    limits += [
        ("forcerange of its actuator", model.actuator_forcerange[actuator])
        for actuator in _actuators_of(model, j)
        if model.actuator_forcelimited[actuator]
    ]
    for what, (low, high) in limits:
        if not low < 0 < high:
            yield f'joint {name!r}: {what} is "{low:g} {high:g}"; a drive pulls both ways: from below 0 to above it.'


def _actuators_of(model: mujoco.MjModel, j: int) -> list[int]:
    """Return the actuators that act on a joint."""
    on_joints = model.actuator_trntype == int(mujoco.mjtTrn.mjTRN_JOINT)
    return np.flatnonzero(on_joints & (model.actuator_trnid[:, 0] == j)).tolist()


def servo_gains(model: mujoco.MjModel, j: int) -> tuple[float, float]:
    """Return stiffness [Nm/rad] and damping [Nm s/rad] of a position actuator on a joint; zeros if there is none."""
    for actuator in _actuators_of(model, j):
        bias, gear = model.actuator_biasprm[actuator], float(model.actuator_gear[actuator, 0])
        if int(model.actuator_biastype[actuator]) == int(mujoco.mjtBias.mjBIAS_AFFINE) and bias[1] < 0:
            return -float(bias[1]) * gear**2, -float(bias[2]) * gear**2
    return 0.0, 0.0
