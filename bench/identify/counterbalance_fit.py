"""C and l_c of a hydropneumatic counterbalance from its torque, Eq. (34), with intervals, k_b and the rival law.

C and l_c are nearly degenerate: a narrow range determines F = C / (l_c - l) in its middle and little else. The
likelihood is a long ridge; its profile gives intervals that need not be symmetric and may have no upper end.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtri

from bench.errors import InputError
from bench.identify.balancing_torque import BalancingTorque, Geometry
from bench.identify.gas_law_problem import GasLawProblem, Spring
from bench.identify.gas_law_profile import intervals, minimum
from bench.record.campaign import Array
from bench.robot.counterbalance import Counterbalance

DECIDED = 6.0  # difference of chi-square: 20 to 1 between two laws with as many unknowns
TRUSTED = 0.005  # share of M to which the shape of a computed torque is believed, whatever the noise
DEGENERATE = 0.99  # correlation above which a note is due
TOO_LARGE = 1.2  # chi-square per degree of freedom above which a note is due


@dataclass(frozen=True)
class CounterbalanceFit:
    """Gas figures with everything needed to judge them.

    Attributes:
        geometry: Of the counterbalance, taken as known.
        gas_constant: C [Nm].
        critical_length: l_c [m].
        covariance: Shape (2, 2), of (C, l_c) [Nm, m], first order, times `scale`.
        intervals: Shape (2, 2), ends of C [Nm] and of l_c [m] by profile likelihood; inf where the data set no end.
        level: Of the intervals.
        chi_square: Of the gas law.
        spring: The best linear spring with its chi-square.
        spring_misfit: Root mean square of M by that spring less M by the gas law, over the data [Nm].
        degrees_of_freedom: Of both laws.
        scale: Factor on all variances: chi-square per degree of freedom where that exceeds 1.
        nuisances: What the data say about everything else that M depends on, in prior standard deviations.
        corrected: For each traverse, shape (B,) [Nm]: M less what the nuisances account for.
        largest: Largest |M| [Nm].
        notes: What these data cannot tell, and what would; one sentence each.
    """

    geometry: Geometry
    gas_constant: float
    critical_length: float
    covariance: Array
    intervals: Array
    level: float
    chi_square: float
    spring: Spring
    spring_misfit: float
    degrees_of_freedom: int
    scale: float
    nuisances: Mapping[str, float]
    corrected: tuple[Array, ...]
    largest: float
    notes: tuple[str, ...] = ()

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
        """The law that the data prefer: "gas", "spring", or "cannot tell".

        They cannot tell where the laws differ by less than the noise, or by less than a computed torque is believed.
        """
        difference = (self.spring.chi_square - self.chi_square) / self.scale
        if abs(difference) < DECIDED or self.spring_misfit < TRUSTED * self.largest:
            return "cannot tell"
        return "gas" if difference > 0 else "spring"

    def torque_sigma(self, theta: Array) -> Array:
        """Return the standard deviation of the predicted M [Nm]; theta of shape (T,) [rad]."""
        law = self.counterbalance
        torque = law.torque(theta)
        return self._propagated(torque / self.gas_constant, -torque / (self.critical_length - law.length(theta)))

    def stiffness_sigma(self, theta: Array) -> Array:
        """Return the standard deviation of k_b, Eq. (12) [Nm/rad]; theta of shape (T,) [rad]."""
        law = self.counterbalance
        k_b = law.stiffness(theta)
        by_length = -(k_b + law.torque(theta) ** 2 / self.gas_constant) / (self.critical_length - law.length(theta))
        return self._propagated(k_b / self.gas_constant, by_length)

    def _propagated(self, by_constant: Array, by_length: Array) -> Array:
        gradient = np.stack([by_constant, by_length])
        sigma: Array = np.sqrt(np.einsum("it,ij,jt->t", gradient, self.covariance, gradient))
        return sigma


def fit_counterbalance(
    torques: Sequence[BalancingTorque],
    geometry: Geometry,
    nuisance_names: Sequence[str],
    limits: Array,
    level: float = 0.95,
) -> CounterbalanceFit:
    """Identify C and l_c by generalised least squares over all traverses.

    Args:
        torques: M of at least one traverse.
        geometry: Of the counterbalance.
        nuisance_names: Of the columns of `BalancingTorque.sensitivity`.
        limits: Shape (2,) [rad], range of the joint, for advice on a wider sweep.
        level: Of the intervals.

    Raises:
        InputError: The torque is not one that a gas-loaded cylinder in these anchors can have made.
    """
    problem = GasLawProblem.build(torques, geometry)
    best = minimum(problem)
    if best.gas_constant <= 0:
        raise InputError("the counterbalance pushes where it should pull; check the current's sign and the geometry.")
    freedom = len(problem) - 2
    scale = max(1.0, best.chi_square / freedom)
    model = best.gas_constant * problem.per_gas_constant(best.critical_length)
    spring = problem.spring()
    theta = np.concatenate([t.theta for t in torques])
    found = problem.nuisances(problem.torque - model)
    fit = CounterbalanceFit(
        geometry=geometry,
        gas_constant=best.gas_constant,
        critical_length=best.critical_length,
        covariance=scale * problem.covariance(best.gas_constant, best.critical_length),
        intervals=intervals(problem, best, scale * float(chdtri(1, 1 - level))),
        level=level,
        chi_square=best.chi_square,
        spring=spring,
        spring_misfit=float(np.sqrt(np.mean((spring.torque(theta, geometry) - model) ** 2))),
        degrees_of_freedom=freedom,
        scale=scale,
        nuisances=dict(zip(nuisance_names, map(float, found), strict=True)),
        corrected=tuple(t.torque - t.sensitivity @ found for t in torques),
        largest=float(np.abs(model).max()),
    )
    return replace(fit, notes=tuple(_notes(fit, theta, limits)))


def _notes(fit: CounterbalanceFit, theta: Array, limits: Array) -> list[str]:
    notes = []
    reach = "{:.0f} to {:.0f} deg".format(*np.rad2deg([theta.min(), theta.max()]))
    full = "{:.0f} to {:.0f} deg".format(*np.rad2deg(limits))
    if abs(fit.correlation) > DEGENERATE:
        middle = np.array([np.quantile(np.abs(theta - fit.geometry.dead_centre), 0.75) + fit.geometry.dead_centre])
        force_error = float(fit.torque_sigma(middle)[0] / abs(fit.counterbalance.torque(middle)[0]))
        constant_error = float(np.sqrt(fit.covariance[0, 0]) / fit.gas_constant)
        gain = _spread_of_constant(fit, theta.min(), theta.max()) / _spread_of_constant(fit, *limits)
        notes.append(
            f"C and l_c are correlated {fit.correlation:.3f}: {reach} determine C / (l_c - l) there to "
            f"{force_error:.2%}, but C only to {constant_error:.2%}; as far as noise goes, a sweep of {full} tells C "
            f"{gain:.0f} times better."
        )
    if fit.preferred == "cannot tell":
        notes.append(
            f"gas law or linear spring cannot be decided over {reach}: the best spring is {fit.spring_misfit:.1f} Nm "
            f"rms of {fit.largest:.0f} Nm away, less than a dynamic model is good for; sweep {full}."
        )
    if fit.chi_square > TOO_LARGE * fit.degrees_of_freedom:
        notes.append(
            f"the residuals are {np.sqrt(fit.scale):.1f} times the noise: something is missing in the model; intervals "
            "are widened by that factor, which makes them honest only if what is missing looks like noise."
        )
    return notes


def _spread_of_constant(fit: CounterbalanceFit, low: float, high: float) -> float:
    """Return the standard deviation of C that equal noise over a range gives, up to a factor."""
    law = fit.counterbalance
    theta = np.arange(low, high, np.deg2rad(0.5))
    gap = fit.critical_length - law.length(theta)
    theta, gap = theta[gap > 0], gap[gap > 0]
    torque = law.torque(theta)
    jacobian = np.column_stack([torque / fit.gas_constant, -torque / gap]) * [fit.gas_constant, 1.0]
    return float(np.sqrt(np.linalg.inv(jacobian.T @ jacobian)[0, 0]))
