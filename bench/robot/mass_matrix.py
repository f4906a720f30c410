"""Mass matrices, dense, of MuJoCo's model of a robot."""

import mujoco
import numpy as np

from bench.robot.bodies import Array
from bench.robot.compiled import CompiledRobot


def mass_matrix(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    """Return the mass matrix of all degrees of freedom, shape (nv, nv) [kg m^2]; `data` has gone through `mj_makeM`."""
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    return full


def link_mass_matrix(compiled: CompiledRobot, q: Array) -> Array:
    """Return the mass matrix of the links, rotors apart, at angles q, shape (n,) [rad]; shape (n, n) [kg m^2]."""
    at = compiled.at
    data = mujoco.MjData(compiled.model)
    data.qpos[at.theta] = data.qpos[at.q] = q
    mujoco.mj_fwdPosition(compiled.model, data)
    return mass_matrix(compiled.model, data)[np.ix_(at.theta_dof, at.theta_dof)]
