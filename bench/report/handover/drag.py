"""Friction that MuJoCo's damping has, for other programs: viscous, or of higher powers of speed."""

import numpy as np

from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot


def drag_of(compiled: CompiledRobot) -> Array:
    """Return the coefficients of v, v|v| and v^3 of each joint, of motor and link side together, shape (n, 3) [SI]."""
    model, at = compiled.model, compiled.at
    every = np.concatenate([model.dof_damping[:, None], model.dof_dampingpoly], axis=1)
    return np.asarray(every[at.q_dof] + every[at.theta_dof])


def drag_torque(compiled: CompiledRobot, velocity: Array) -> Array:
    """Return what turns joints against that friction, shape (T, n) [Nm].

    Args:
        compiled: The robot.
        velocity: Shape (T, n) [rad/s].
    """
    first, second, third = drag_of(compiled).T
    return np.asarray((first + second * np.abs(velocity) + third * velocity**2) * velocity)
