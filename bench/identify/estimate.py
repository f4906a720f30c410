"""What every identification method returns."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from bench.robot.bodies import Array


@dataclass(frozen=True)
class StiffnessEstimate:
    """Joint stiffness with everything needed to judge it.

    The deflection is linear in the compliance N_j = 1 / k_j (Eq. 37), so the compliance is what is estimated, what
    carries the covariance, and what is close to normally distributed; intervals of k are the reciprocals of intervals
    of N.

    Attributes:
        method: "current", "force", "force-pose", "force-paper" or "joint".
        joint_names: Length n.
        compliance: Shape (n,) [rad/Nm]; nan where these data cannot tell.
        covariance: Shape (n, n) [(rad/Nm)^2]; nan in rows and columns of joints that these data cannot tell.
        degrees_of_freedom: Of the residual variance; inf where the noise level was known rather than estimated.
        condition_number: Of the column-scaled regressor over the observable joints.
        observable: Shape (n,) bool.
        residuals: Channel -> residual of the fit, in units of that channel's standard deviation.
        notes: What these data cannot tell and which pose or load would; one sentence each.
    """

    method: str
    joint_names: tuple[str, ...]
    compliance: Array
    covariance: Array
    degrees_of_freedom: float
    condition_number: float
    observable: NDArray[np.bool_]
    residuals: Mapping[str, Array]
    notes: tuple[str, ...]

    @property
    def stiffness(self) -> Array:
        """Shape (n,) [Nm/rad]; k_j = 1 / N_j."""
        return 1.0 / self.compliance

    @property
    def standard_error(self) -> Array:
        """Shape (n,) [Nm/rad]; first order in the error of the compliance."""
        return np.sqrt(np.diag(self.covariance)) * self.stiffness**2

    def interval(self, level: float = 0.95) -> Array:
        """Shape (n, 2) [Nm/rad]; lower and upper end; the upper end is inf where a rigid joint cannot be excluded."""
        quantile = stdtrit(self.degrees_of_freedom, 0.5 + level / 2)
        half = quantile * np.sqrt(np.diag(self.covariance))
        with np.errstate(divide="ignore"):
            upper = np.where(self.compliance - half > 0, 1.0 / (self.compliance - half), np.inf)
        upper = np.where(np.isnan(self.compliance), np.nan, upper)
        return np.stack([1.0 / (self.compliance + half), upper], axis=1)


@dataclass(frozen=True)
class JointEstimate(StiffnessEstimate):
    """What the joint method returns: stiffness, and what it had to learn about friction and currents on the way.

    Attributes:
        link_share: Shape (n,), share of the link side, behind the elastic element, in the change of friction under
            load.
        link_share_sigma: Shape (n,), its standard deviation; 0.5 where nothing was learnt.
        friction_scale: Shape (n,) [Nm], size of the change of friction under load, both sides together.
        current_gain: Shape (n,), relative gain of the load's torque over the current's.
        current_gain_sigma: Shape (n,), its standard deviation.
    """

    link_share: Array
    link_share_sigma: Array
    friction_scale: Array
    current_gain: Array
    current_gain_sigma: Array
