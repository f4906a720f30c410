"""The drives of a robot as plain numbers, for identification; `RigidBodies` holds the links."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bench.robot.bodies import Array, read_only

if TYPE_CHECKING:
    from bench.robot.compiled import CompiledRobot


@dataclass(frozen=True)
class Drives:
    """What lies between a current and a link; n drives, everything reflected to the joint.

    Attributes:
        torque_constant: Shape (n,) [Nm/A], xi of Eq. (33) and Table 2.
        torque_gain_sigma: Shape (n,), relative standard deviation of xi times current: constant and sensor together.
        current_sigma: Standard deviation of one reading of a current, rounding included [A].
        current_offset_sigma: Of a reading's constant error [A].
        rotor_inertia: Shape (n,) [kg m^2], J_m N^2.
        stiffness: Shape (n,) [Nm/rad], of the elastic elements, k of Table 6.
    """

    torque_constant: Array
    torque_gain_sigma: Array
    current_sigma: float
    current_offset_sigma: float
    rotor_inertia: Array
    stiffness: Array


def drives_of(compiled: "CompiledRobot") -> Drives:
    """Return the drives of a compiled robot as its figures and its MJCF give them."""
    figures, model, at = compiled.robot.figures, compiled.model, compiled.at
    current = figures.instruments.current
    gain, sigma, offset, resolution = (
        (current.gain_sigma, current.sigma_a, current.offset_sigma_a, current.resolution_a) if current else (0.0,) * 4
    )
    error = np.array([drive.torque_constant_error for drive in figures.drives])
    return Drives(
        torque_constant=read_only(compiled.torque_constant),
        torque_gain_sigma=read_only(np.hypot(gain, error)),
        current_sigma=float(np.hypot(sigma, resolution / np.sqrt(12))),  # of rounding to 1: 1 / sqrt(12)
        current_offset_sigma=offset,
        rotor_inertia=read_only(model.dof_armature[at.q_dof]),
        stiffness=read_only(compiled.stiffness),
    )
