"""Where the reflectors of rigid links are, and their Jacobians."""

import mujoco
import numpy as np

from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot


def reflector_jacobians(compiled: CompiledRobot, theta: Array) -> Array:
    """Return how far reflectors move with the links, shape (T, r, 3, n) [m/rad], of a slide [m/m].

    Args:
        compiled: The robot.
        theta: Shape (T, n) [rad] or [m], of the links.
    """
    model, at = compiled.model, compiled.at
    data = mujoco.MjData(model)
    full = np.empty((3, model.nv))
    found = np.empty((len(theta), len(at.reflectors), 3, compiled.n_joints))
    for i, links in enumerate(theta):
        data.qpos[at.theta] = links
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        for k, site in enumerate(at.reflectors.tolist()):
            mujoco.mj_jacSite(model, data, full, None, site)
            found[i, k] = full[:, at.theta_dof]
    return found


def reflector_places(compiled: CompiledRobot, theta: Array) -> Array:
    """Return where reflectors are, shape (T, r, 3) [m], in world axes.

    Args:
        compiled: The robot.
        theta: Shape (T, n) [rad] or [m], of the links; passive hinges do not give.
    """
    model, at = compiled.model, compiled.at
    data = mujoco.MjData(model)
    found = np.empty((len(theta), len(at.reflectors), 3))
    for i, links in enumerate(theta):
        data.qpos[at.theta] = links
        mujoco.mj_kinematics(model, data)
        found[i] = data.site_xpos[at.reflectors]
    return found
