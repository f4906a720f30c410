"""Deviations of friction from the law of the joint method, and the mean over what their size may be.

The law and the reasons stand in `bench.identify.joint`.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.identify.gls import SeriesModel, Solution, solve, whiten
from bench.identify.joint_problem import JointProblem
from bench.robot.bodies import Array

SPREADS = (0.01, 0.03, 0.1, 0.3, 1.0)  # grid of sqrt(v_1) and sqrt(v_2), in units of S


def with_spread(problem: JointProblem, lasting: float, passing: float) -> tuple[SeriesModel, Array]:
    """Return the model with the deviations, and the prior sigmas of the parameters, shape (p,).

    Args:
        problem: The problem without them.
        lasting: sqrt(v_1), of the level beta that a joint keeps.
        passing: sqrt(v_2), of what differs from state to state.
    """
    n = problem.deviation.shape[2]
    first = problem.is_first[:, None, None]
    share = np.clip(problem.share, 0.0, 1.0)
    undecided = problem.friction.may_stick[:, None, :] * np.sqrt(share * (1 - share))
    later = np.where(first, 0.0, problem.deviation) * np.hypot(passing, undecided)
    model = replace(
        problem.model,
        covariance=problem.model.covariance + later @ later.transpose(0, 2, 1),
        shared=np.where(first, passing * problem.deviation, 0.0),
    )
    sigma = problem.prior_sigma.copy()
    sigma[2 * n : 3 * n] *= lasting
    return model, sigma


def solve_joint(problem: JointProblem, used: NDArray[np.bool_], spreads: Sequence[float] = SPREADS) -> Solution:
    """Return the mixture over the grid of spreads, equally likely beforehand.

    Args:
        problem: The problem without deviations.
        used: Shape (n,) bool; the other joints get no parameter.
        spreads: Values of both spreads on the grid.
    """
    columns = np.concatenate([np.tile(used, 4), np.ones(3, dtype=np.bool_)])
    solutions = []
    for lasting in spreads:
        for passing in spreads:
            model, sigma = with_spread(problem, lasting, passing)
            white = whiten(replace(model, regressor=model.regressor[:, :, columns]))
            solutions.append(solve(white, problem.prior_mean[columns], sigma[columns]))
    return mixture(solutions)


def mixture(solutions: Sequence[Solution]) -> Solution:
    """Return mean and covariance over solutions, weighted by restricted likelihood; all else is of the likeliest."""
    likelihood = np.array([solution.log_likelihood for solution in solutions])
    weight = np.exp(np.maximum(likelihood - likelihood.max(), -700.0))
    weight /= weight.sum()
    parameters = np.stack([solution.parameters for solution in solutions])
    mean = weight @ parameters
    apart = parameters - mean
    covariance = np.einsum("g,gij->ij", weight, np.stack([solution.covariance for solution in solutions]))
    covariance += (weight[:, None] * apart).T @ apart
    return replace(solutions[int(likelihood.argmax())], parameters=mean, covariance=covariance)
