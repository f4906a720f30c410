"""C and l_c of a hydropneumatic counterbalance from its torque, Eq. (34), with intervals, k_b and the rival law.

C and l_c are nearly degenerate: over a narrow range only F = C / (l_c - l) at its middle is well determined. The likelihood
is then a long bent ridge, and its profile gives the intervals: they are not symmetric, and may have no upper end.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.stats import chi2, norm

from bench.errors import InputError
from bench.identify.balancing_torque import BalancingTorque, Geometry
from bench.identify.gas_law_problem import GasLawProblem
from bench.record.campaign import Array
from bench.robot.counterbalance import Counterbalance

NEAREST, FARTHEST = 1e-4, 1e3  # [m], l_c beyond the longest cylinder measured; 1 km is a constant force
GRID = 60  # points over which the minimum is looked for before it is refined
DECIDED = 6.0  # difference of chi-square: 20 to 1 between two laws with as many unknowns
DEGENERATE = 0.99  # correlation above which C and l_c are called not separately determined


@dataclass(frozen=True)
class CounterbalanceFit:
    """Gas figures with everything needed to judge them.

    Attributes:
        geometry: Of the counterbalance, taken as known.
        gas_constant: C [Nm].
        critical_length: l_c [m].
        covariance: Shape (2, 2), of (C, l_c) [Nm, m], first order; widened by `scale`.
        intervals: Shape (2, 2), profile-likelihood ends of C [Nm] and l_c [m]; inf where data set no upper end.
        level: Of the intervals.
        chi_square: Of the gas law.
        spring_chi_square: Of a linear spring between the anchors, with as many unknowns.
        degrees_of_freedom: Of both.
        scale: Factor on all variances: chi-square per degree of freedom where that exceeds 1.
        nuisances: What the data say about what else M depends on: name -> mean, in prior standard deviations.
        corrected: Shape (B,) [Nm] for each traverse: M less what the nuisances account for.
        notes: What these data cannot tell and what would; one sentence each.
    """

    geometry: Geometry
    gas_constant: float
    critical_length: float
    covariance: Array
    intervals: Array
    level: float
    chi_square: float
    spring_chi_square: float
    degrees_of_freedom: int
    scale: float
    nuisances: Mapping[str, float]
    corrected: tuple[Array, ...]
    notes: tuple[str, ...]

    @property
    def counterbalance(self) -> Counterbalance:
        """The counterbalance with the identified gas."""
        return self.geometry.filled(self.gas_constant, self.critical_length)

    @property
    def correlation(self) -> float:
        """Of C and l_c."""
        return float(self.covariance[0, 1] / np.sqrt(self.covariance[0, 0] * self.covariance[1, 1]))

    @property
    def preferred(self) -> str:
        """Law that these data prefer: "gas", "spring", or "cannot tell"."""
        difference = (self.spring_chi_square - self.chi_square) / self.scale
        return "gas" if difference > DECIDED else "spring" if difference < -DECIDED else "cannot tell"

    def torque_sigma(self, theta: Array) -> Array:
        """Return the standard deviation of the predicted M [Nm]; the shape of theta [rad], one dimension."""
        law = self.counterbalance
        torque = law.torque(theta)
        return self._propagated(torque / self.gas_constant, -torque / (self.critical_length - law.length(theta)))

    def stiffness_sigma(self, theta: Array) -> Array:
        """Return the standard deviation of k_b, Eq. (12) [Nm/rad]; the shape of theta [rad], one dimension."""
        law = self.counterbalance
        k_b = law.stiffness(theta)
        slope = -(k_b + law.torque(theta) ** 2 / self.gas_constant) / (self.critical_length - law.length(theta))
        return self._propagated(k_b / self.gas_constant, slope)

    def _propagated(self, by_constant: Array, by_length: Array) -> Array:
        gradient = np.stack([by_constant, by_length])
        return np.sqrt(np.einsum("ib,ij,jb->b", gradient, self.covariance, gradient))


def fit_counterbalance(
    torques: Sequence[BalancingTorque],
    geometry: Geometry,
    nuisance_names: Sequence[str],
    limits: tuple[float, float],
    level: float = 0.95,
) -> CounterbalanceFit:
    """Identify C and l_c by generalised least squares over all traverses.

    Args:
        torques: M of at least one traverse.
        geometry: Of the counterbalance.
        nuisance_names: Of the columns of `BalancingTorque.sensitivity`.
        limits: Range of the joint [rad], for advice on a wider sweep.
        level: Of the intervals.

    Raises:
        InputError: The torque is not one that a cylinder in these anchors can have made.
    """
    problem = GasLawProblem.build(torques, geometry)
    longest = float(problem.length.max())
    log_gap = _minimum(lambda u: problem.for_critical_length(longest + np.exp(u))[1])
    critical_length = float(longest + np.exp(log_gap))
    constant, chi_square, _ = problem.for_critical_length(critical_length)
    if constant <= 0:
        raise InputError("the counterbalance pushes where it should pull; check the sign of the current and the geometry.")
    dof = len(problem) - 2
    scale = max(1.0, chi_square / dof)
    rise = float(chi2.ppf(level, 1)) * scale
    residual = problem.torque - constant * problem.per_gas_constant(critical_length)
    found = problem.nuisances(residual)
    covariance = scale * problem.covariance(constant, critical_length)
    fit = CounterbalanceFit(
        geometry=geometry,
        gas_constant=constant,
        critical_length=critical_length,
        covariance=covariance,
        intervals=_profile(problem, longest, log_gap, chi_square, rise),
        level=level,
        chi_square=chi_square,
        spring_chi_square=problem.spring_chi_square(),
        degrees_of_freedom=dof,
        scale=scale,
        nuisances=dict(zip(nuisance_names, map(float, found), strict=True)),
        corrected=tuple(t.torque - t.sensitivity @ found for t in torques),
        notes=(),
    )
    return fit


def _minimum(chi_square: Callable[[float], float]) -> float:
    """Return where a chi-square over ln(l_c - l_max) is least."""
    grid = np.linspace(np.log(NEAREST), np.log(FARTHEST), GRID)
    best = int(np.argmin([chi_square(u) for u in grid]))
    low, high = grid[max(best - 1, 0)], grid[min(best + 1, GRID - 1)]
    return float(minimize_scalar(chi_square, bounds=(low, high), method="bounded", options={"xatol": 1e-9}).x)


def _profile(problem: GasLawProblem, longest: float, log_gap: float, least: float, rise: float) -> Array:
    """Return the profile-likelihood intervals of C and l_c, shape (2, 2): where chi-square has risen by `rise`."""

    def left(u: float) -> float:
        return rise - (problem.for_critical_length(longest + np.exp(u))[1] - least)

    def constant_end(sign: int) -> float:
        def end(u: float) -> float:
            constant, _, curvature = problem.for_critical_length(longest + np.exp(u))
            return -sign * (constant + sign * np.sqrt(max(left(u), 0.0) / curvature))

        at = minimize_scalar(end, bounds=tuple(edges), method="bounded", options={"xatol": 1e-6})
        return -sign * float(at.fun)

    extremes = np.log(NEAREST), np.log(FARTHEST)
    edges = [extreme if left(extreme) > 0 else brentq(left, log_gap, extreme, xtol=1e-9) for extreme in extremes]
    open_end = edges[1] == extremes[1]
    upper = (np.inf, np.inf) if open_end else (constant_end(1), longest + np.exp(edges[1]))
    return np.array([[constant_end(-1), upper[0]], [longest + np.exp(edges[0]), upper[1]]])
