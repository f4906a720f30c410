"""The hydropneumatic counterbalance in closed form: a gas-loaded cylinder between two links, Eqs. (8) to (12).

The paper's Eq. (9) is written for the Denavit-Hartenberg angle of joint 2, which is the joint angle less 90 deg; with
it, sin(alpha - theta_DH) becomes cos(theta - alpha). Here theta is the joint angle and alpha the *dead centre*: the
joint angle at which anchor A, joint and anchor B lie in line, the cylinder is shortest and its torque is zero (about
3.3 deg for the HH-150). Read so, the anchor offsets a and h of Eq. (10) are both positive.

The gas volume shrinks as the cylinder grows longer, so the rod pulls, and the torque brings the joint back to the
dead centre: M as the paper defines it is *restoring*, and the torque on the joint in the direction of growing theta
is -M.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bench.actuators.laws import GasSpring
from bench.errors import RobotError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Counterbalance:
    """Geometry and gas figures of a counterbalance on one hinge.

    Attributes:
        joint: Index of the hinge in the arm, from 0.
        rho: Distance from the hinge to anchor A on the fixed side, sqrt(a^2 + h^2) [m].
        b: Distance from the hinge to anchor B on the moving side [m].
        dead_centre: Joint angle at which the cylinder is shortest, alpha [rad].
        gas_constant: C = P V of the gas, Eq. (5) [Nm].
        critical_length: Length at which the gas volume would be zero, l_c of Eq. (7) [m].
        exponent, reference_length: n and l_r [m] of the polytropic law; n = 1 is Eq. (8).
        seal_friction: Friction of the seals as a share of the gas force.
        relaxation_time: In which a difference of temperature falls to 1/e [s]; inf where the gas knows none.
        heat_capacity_ratio: gamma of the gas, which warms up as it is compressed; 1: it never does.
    """

    joint: int
    rho: float
    b: float
    dead_centre: float
    gas_constant: float
    critical_length: float
    exponent: float = 1.0
    reference_length: float = 0.0
    seal_friction: float = 0.0
    relaxation_time: float = np.inf
    heat_capacity_ratio: float = 1.0

    def __post_init__(self) -> None:
        """Refuse figures that no cylinder can have.

        Raises:
            RobotError: A length or C is not positive, both anchors are at the same distance, or the gas volume would
                vanish.
        """
        problems = [
            f"counterbalance: {name} is {value!r}; it must be a positive number."
            for name, value in (("rho", self.rho), ("b", self.b), ("gas_constant", self.gas_constant))
            if not value > 0
        ]
        if self.rho == self.b:
            problems.append("counterbalance: rho equals b: the anchors would meet at the dead centre; correct one.")
        if not self.critical_length > abs(self.rho - self.b):
            problems.append(
                f"counterbalance: critical_length {self.critical_length} m is not above the shortest cylinder, "
                f"|rho - b| = {abs(self.rho - self.b)} m; the gas would have no volume at any angle."
            )
        if problems:
            raise RobotError(problems)

    def length(self, theta: ArrayLike) -> Array:
        """Return the distance of the anchors, l of Eq. (9) [m]. Any shape; theta in rad."""
        lever = self.b * self.rho
        return np.sqrt(self.b**2 + self.rho**2 - 2 * lever * np.cos(self._angle(theta)))

    def lever_arm(self, theta: ArrayLike) -> Array:
        """Return the signed lever arm dl/dtheta of the rod about the hinge [m/rad]; the same shape as theta [rad]."""
        return self.b * self.rho * np.sin(self._angle(theta)) / self.length(theta)

    def force(self, theta: ArrayLike) -> Array:
        """Return the pull of the rod, F = C / (l_c - l), Eq. (8) [N]; nan without gas volume. Shape of theta [rad]."""
        gas_column = self.critical_length - self.length(theta)
        return self.gas_constant / np.where(gas_column > 0, gas_column, np.nan)

    def gas_force(self, pull: Array, length: Array) -> Array:
        """Return what the gas alone pulls [N], which a gauge shows as pressure times area; any shape.

        The seals hold up to `seal_friction` of it either way. Gas that is warmer than its surroundings pulls more than
        the law says: what the rod shows bounds it then.

        Args:
            pull: Of the rod, the seals' friction included [N].
            length: Of the cylinder, the same shape [m].
        """
        if self.seal_friction == 0:
            return pull
        gap = self.critical_length - length
        law = self.gas_constant / gap * ((self.critical_length - self.reference_length) / gap) ** (self.exponent - 1)
        return np.asarray(np.clip(law, pull / (1 + self.seal_friction), pull / (1 - self.seal_friction)))

    def temperature_rise(self, theta: ArrayLike, dt: ArrayLike, rise: float = 0.0) -> Array:
        """Return T / T0 - 1 of the gas at each of some joint angles, shape (T,).

        Args:
            theta: Shape (T,) [rad].
            dt: Between them, shape (T - 1,) [s].
            rise: What it is at the first.
        """
        law = GasSpring(
            constant=self.gas_constant,
            critical_length=self.critical_length,
            heat_capacity_ratio=self.heat_capacity_ratio,
            relaxation_time=self.relaxation_time,
        )
        return law.temperature_rise(self.length(theta), dt, rise)

    def torque(self, theta: ArrayLike) -> Array:
        """Return the restoring torque M = F dl/dtheta, Eq. (11) [Nm]; on the joint acts -M. Shape of theta [rad]."""
        return self.force(theta) * self.lever_arm(theta)

    def stiffness(self, theta: ArrayLike) -> Array:
        """Return k_b = dM/dtheta, Eq. (12), as k_b = M^2 / C + F d2l/dtheta2 [Nm/rad]; the shape of theta [rad]."""
        lever, length, force = self.lever_arm(theta), self.length(theta), self.force(theta)
        bend = (self.b * self.rho * np.cos(self._angle(theta)) - lever**2) / length  # d2l/dtheta2
        return (force * lever) ** 2 / self.gas_constant + force * bend

    def _angle(self, theta: ArrayLike) -> Array:
        return np.asarray(theta, dtype=np.float64) - self.dead_centre
