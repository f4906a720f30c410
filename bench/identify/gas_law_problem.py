"""The fit of a law for the cylinder's force as a least-squares problem, built here and solved in `counterbalance_fit`.

Eq. (34) divides M by the lever arm, which is 0/0 at the dead centre, in the middle of the range. Multiplied out it is
M = l' C / (l_c - l) with the lever arm l' = dl/dtheta, and every angle counts by what it knows.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.identify.balancing_torque import BalancingTorque, Geometry
from bench.record.campaign import Array


@dataclass(frozen=True)
class Spring:
    """The rival law: a linear spring between the anchors, F = k_s (l - l_0).

    Attributes:
        rate: k_s [N/m].
        rest_length: l_0 [m].
        chi_square: Of its best fit.
    """

    rate: float
    rest_length: float
    chi_square: float

    def torque(self, theta: Array, geometry: Geometry) -> Array:
        """Return M [Nm]; the shape of theta [rad]."""
        rod = geometry.rod
        return self.rate * (rod.length(theta) - self.rest_length) * rod.lever_arm(theta)


@dataclass(frozen=True)
class GasLawProblem:
    """Measured M of all traverses with its covariance diag(sigma^2) + S S^T, where S are the nuisance sensitivities.

    The chi-square of a residual r is r^T covariance^-1 r. It is computed as the least squares over the nuisances b,
    with their priors as further rows: min |r / sigma - S b / sigma|^2 + |b|^2.

    Attributes:
        length: Shape (N,) [m], l of Eq. (9).
        lever_arm: Shape (N,) [m], l'.
        torque: Shape (N,) [Nm], M.
        sigma: Shape (N,) [Nm].
        basis, triangle: Shapes (N + m, m) and (m, m), QR factors of the nuisance rows.
    """

    length: Array
    lever_arm: Array
    torque: Array
    sigma: Array
    basis: Array
    triangle: Array

    @classmethod
    def build(cls, torques: Sequence[BalancingTorque], geometry: Geometry) -> "GasLawProblem":
        """Stack traverses into one problem."""
        theta = np.concatenate([t.theta for t in torques])
        sigma = np.concatenate([t.sigma for t in torques])
        sensitivity = np.concatenate([t.sensitivity for t in torques])
        rod = geometry.rod
        rows = np.concatenate([sensitivity / sigma[:, None], np.eye(sensitivity.shape[1])])
        basis, triangle = np.linalg.qr(rows)
        torque = np.concatenate([t.torque for t in torques])
        return cls(rod.length(theta), rod.lever_arm(theta), torque, sigma, basis, triangle)

    def __len__(self) -> int:
        return len(self.torque)

    def whitened(self, torque: Array) -> Array:
        """Return rows whose sum of squares is chi-square, shape (N + m, ...), of torques of shape (N, ...) [Nm]."""
        rows = np.zeros((len(self.basis), *torque.shape[1:]))
        rows[: len(self)] = (torque.T / self.sigma).T
        free: Array = rows - self.basis @ (self.basis.T @ rows)
        return free

    def nuisances(self, residual: Array) -> Array:
        """Return the nuisances in prior standard deviations, shape (m,), by the residual M - model, shape (N,) [Nm]."""
        return np.asarray(
            np.linalg.solve(self.triangle, self.basis[: len(self)].T @ (residual / self.sigma)), np.float64
        )

    def per_gas_constant(self, critical_length: float) -> Array:
        """Return M / C = l' / (l_c - l), shape (N,)."""
        return self.lever_arm / (critical_length - self.length)

    def for_critical_length(self, critical_length: float) -> tuple[float, float, float]:
        """Return the best C [Nm] for a given l_c [m], its chi-square, and 1 / sigma_C^2; M is linear in C."""
        column, target = self.whitened(self.per_gas_constant(critical_length)), self.whitened(self.torque)
        curvature = float(column @ column)
        constant = float(column @ target) / curvature
        return constant, float(np.sum((target - constant * column) ** 2)), curvature

    def spring(self) -> "Spring":
        """Return the best linear spring, which has as many unknowns as the gas law has."""
        columns = self.whitened(np.column_stack([self.lever_arm, self.lever_arm * self.length]))
        target = self.whitened(self.torque)
        at_zero, rate = np.linalg.lstsq(columns, target, rcond=None)[0]
        chi_square = float(np.sum((target - columns @ np.array([at_zero, rate])) ** 2))
        return Spring(float(rate), float(-at_zero / rate), chi_square)

    def covariance(self, constant: float, critical_length: float) -> Array:
        """Return the covariance of (C, l_c) at a point, shape (2, 2), first order."""
        per_constant = self.per_gas_constant(critical_length)
        slope = -constant * per_constant / (critical_length - self.length)
        jacobian = self.whitened(np.column_stack([per_constant, slope]))
        scale = np.linalg.norm(jacobian, axis=0)
        return np.linalg.inv((jacobian / scale).T @ (jacobian / scale)) / np.outer(scale, scale)
