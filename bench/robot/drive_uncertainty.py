"""How well the figures of each drive are known."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.robot.bodies import Array

UNKNOWN = 1.0  # relative: a figure that is so uncertain says as much as nothing: 0 is one standard deviation away


@dataclass(frozen=True)
class DriveUncertainty:
    """Relative standard deviations of the figures of n drives, as stated.

    Attributes:
        friction: Shape (n,), of each Coulomb level and of the viscous coefficient.
        rotor_inertia: Shape (n,), of the rotor with its gear.
        stiffness: Shape (n,), of the elastic element; 3: known to a factor of 4.
    """

    friction: Array
    rotor_inertia: Array
    stiffness: Array

    @property
    def rotor_is_unknown(self) -> NDArray[np.bool_]:
        """Whether nobody knows the rotor of a drive, shape (n,): what a file states is known to 0.1, a guess to 3."""
        return np.asarray(self.rotor_inertia >= UNKNOWN)
