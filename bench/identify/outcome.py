"""From the parameters of a fit to an estimate that says what it does not know."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from bench.identify.estimate import StiffnessEstimate
from bench.identify.gls import SeriesModel, Solution, equal_weights, solve, whiten
from bench.identify.options import Options
from bench.robot.bodies import Array

SIGNAL_TO_NOISE = 10.0  # of a joint's torque as a regressor; its noise then shrinks the compliance by less than 1 %
RIGID_QUANTILE = 1.959964  # 95 %: a joint is observed when its interval excludes a rigid joint
LACK_OF_FIT = 0.01  # significance at which residuals are larger than the instruments explain

NO_NUISANCE = np.zeros(0)


def is_signal(change: Array, sigma: Array) -> NDArray[np.bool_]:
    """Return which joints carry a torque that is more than noise, shape (n,) bool.

    A column of nothing but noise would still look informative to least squares, which takes regressors for exact.

    Args:
        change: Shape (m, n) [Nm], torque less that of the unloaded state of the series.
        sigma: Shape (n,) or (m, n) [Nm], its standard deviation.
    """
    moved = np.any(change != 0, axis=1)
    power = np.mean(change[moved] ** 2, axis=0) if moved.any() else np.zeros(change.shape[1])
    noise = np.mean(np.broadcast_to(sigma, change.shape) ** 2, axis=0)
    numerical = 1e-12 * power.max(initial=0.0)
    found: NDArray[np.bool_] = power > SIGNAL_TO_NOISE**2 * noise + numerical
    return found


def excludes_rigid(compliance: Array, covariance: Array) -> NDArray[np.bool_]:
    """Return which joints are observed, shape (n,) bool: the 95 % interval of N_j excludes 0, that is a rigid joint."""
    return compliance > RIGID_QUANTILE * np.sqrt(np.diag(covariance))


def misfit(solution: Solution) -> float:
    """Return how far residual variance exceeds what the instruments explain, as a factor; 1 unless significant."""
    ratio = solution.chi_square / max(solution.degrees_of_freedom, 1)
    by_chance = chdtrc(max(solution.degrees_of_freedom, 1), solution.chi_square)
    return ratio if ratio > 1 and by_chance < LACK_OF_FIT else 1.0


def condition_number(information: Array) -> float:
    """Return the condition number of the column-scaled regressor from its information matrix, nan without columns."""
    if len(information) == 0:
        return np.nan
    scale = 1 / np.sqrt(np.diag(information))
    eigenvalues = np.linalg.eigvalsh(information * np.outer(scale, scale))
    return float(np.sqrt(eigenvalues[-1] / eigenvalues[0])) if eigenvalues[0] > 0 else np.inf


def fit_compliance(
    method: str,
    joint_names: tuple[str, ...],
    build: Callable[[Array], SeriesModel],
    used: NDArray[np.bool_],
    gain_covariance: Callable[[Array], Array],
    options: Options,
    nuisance_sigma: Array = NO_NUISANCE,
) -> StiffnessEstimate:
    """Fit the compliance by Gauss-Newton from a rigid arm.

    Args:
        method: Its name.
        joint_names: Length n.
        build: Compliance, shape (n,) -> the problem linearised there; its parameters are N and then nuisances.
        used: Shape (n,) bool, joints whose torque is a signal; the others stay rigid in the fit and are not reported.
        gain_covariance: Compliance -> covariance due to gain errors that these readings cannot reveal, shape (n, n).
        options: Options.
        nuisance_sigma: Prior standard deviations of the nuisances; their prior means are zero.
    """
    n = len(joint_names)
    columns = np.concatenate([np.flatnonzero(used), n + np.arange(len(nuisance_sigma))])
    prior_sigma = np.concatenate([np.full(int(used.sum()), np.inf), nuisance_sigma])
    compliance = np.zeros(n)
    weigh = whiten if options.weights == "noise" else equal_weights
    for _ in range(options.iterations):
        problem = weigh(build(compliance))
        problem = replace(problem, regressor=problem.regressor[:, columns])
        solution = solve(problem, np.zeros(len(columns)), prior_sigma)
        compliance[used] = solution.parameters[: used.sum()]
    by_residuals = options.weights == "equal"
    return estimate(method, joint_names, used, solution, gain_covariance(compliance), by_residuals)


def estimate(
    method: str,
    joint_names: tuple[str, ...],
    used: NDArray[np.bool_],
    solution: Solution,
    gain_covariance: Array,
    by_residuals: bool = False,
) -> StiffnessEstimate:
    """Return the estimate from a solution whose first parameters are the compliances of the used joints.

    Where the residuals are significantly larger than the instruments explain, the model is wrong for these readings;
    the covariance is then scaled by their ratio, and a note says so.

    Args:
        method: Its name.
        joint_names: Length n.
        used: Shape (n,) bool.
        solution: From the last iteration.
        gain_covariance: Shape (n, n), added unscaled.
        by_residuals: The noise level is that of the residuals in any case.
    """
    n, count = len(joint_names), int(used.sum())
    ratio = solution.chi_square / max(solution.degrees_of_freedom, 1) if by_residuals else misfit(solution)
    compliance = np.full(n, np.nan)
    covariance = np.full((n, n), np.nan)
    compliance[used] = solution.parameters[:count]
    covariance[np.ix_(used, used)] = ratio * solution.covariance[:count, :count] + gain_covariance[np.ix_(used, used)]
    observable = used.copy()
    observable[used] = excludes_rigid(compliance[used], covariance[np.ix_(used, used)])
    compliance[~observable] = np.nan
    covariance[~observable] = np.nan
    covariance[:, ~observable] = np.nan
    seen = np.flatnonzero(observable[used])
    return StiffnessEstimate(
        method=method,
        joint_names=joint_names,
        compliance=compliance,
        covariance=covariance,
        degrees_of_freedom=solution.degrees_of_freedom if ratio != 1 else np.inf,
        condition_number=condition_number(solution.information[np.ix_(seen, seen)]),
        observable=observable,
        residuals={"reflector": solution.residual},
        notes=_notes(joint_names, used, observable, ratio),
    )


def _notes(
    joint_names: tuple[str, ...], used: NDArray[np.bool_], observable: NDArray[np.bool_], ratio: float
) -> tuple[str, ...]:
    notes = []
    for name, has_signal, is_observable in zip(joint_names, used, observable, strict=True):
        if not has_signal:
            notes.append(f"{name} is not observable: these loads put no torque on it beyond the noise of its reading.")
        elif not is_observable:
            notes.append(f"{name} is not observable: a rigid joint cannot be excluded at 95 % from these readings.")
    if ratio > 1:
        notes.append(
            f"Residuals are {np.sqrt(ratio):.1f} times what the instruments explain, so something is missing from the "
            "model (friction on the other side of the elastic element, wrong poses); the intervals were widened by it."
        )
    return tuple(notes)
