"""What not even the richest model explains is noise too: by how much the standard errors of quantities are too small.

A real drive has cogging, a real arm rings, a clock jitters. One factor for a whole campaign would let the worst channel
drown the others; so each quantity has its own, at rest and in motion. Neighbours that err alike count as one reading.

While a model is still far from the data, signatures are those of a wrong model, good to a share of what it misses: no
quantity counts as known better than half of that. As the model grows, standard errors fall to what instruments have.
"""

import numpy as np
from scipy.linalg import cho_solve, solve_triangular

from bench.diagnose.linearise.autocorrelation import alike
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.marginal import AT_A_TIME, Columns
from bench.record.campaign import Array

RIDGE = 1.0  # exact: the richest model keeps the priors of its columns
SHARE_OF_MISSES = 0.5  # assumed: of what the present model misses, below which no standard error goes
# rounding: of a reading, that its own fit may take away; one that decides its own fit tells nothing of scatter
MOST_LEVERAGE = 0.9
FEW = 10  # declared: readings that say nothing of their own scatter
SETTLED = 1.2  # effort: times; standard errors that change by less are settled


def unexplained(linear: LinearisedModel, white: Array, columns: Columns, prior: Array) -> Array:
    """Return what not even the richest model explains, in standard errors of every quantity, shape (2, c).

    The first row holds rests, the second motion; neighbours that err alike count once.

    Args:
        linear: The campaign, with the standard errors of the instruments.
        white: Shape (m,), residual of the model so far, nuisances at zero.
        columns: Whitened, of everything that could be added to it; q.
        prior: Shape (q,), standard deviations of the columns' sizes.
    """
    p = linear.jacobian.shape[1]
    normal = np.empty((p + len(prior), p + len(prior)))
    normal[:p, :p] = linear.jacobian.T @ linear.jacobian
    normal[p:, :p] = (columns.with_slopes(linear.jacobian) * prior).T
    normal[:p, p:] = normal[p:, :p].T
    normal[p:, p:] = prior[:, None] * columns.gram * prior
    normal[np.diag_indices_from(normal)] += RIDGE
    root = np.linalg.cholesky(normal)
    pull = np.concatenate([linear.jacobian.T @ white, prior * (columns.matrix.T @ white)])
    sizes = cho_solve((root, True), pull)
    left = white - linear.jacobian @ sizes[:p] - columns.matrix @ (prior * sizes[p:])
    # what each reading's own fit took away from its scatter
    leverage = np.empty(len(white))
    for start in range(0, len(white), AT_A_TIME):
        rows = slice(start, start + AT_A_TIME)
        rich = np.concatenate([linear.jacobian[rows], columns.matrix[rows] * prior], axis=1)
        own = solve_triangular(root, rich.T, lower=True, overwrite_b=True, check_finite=False)
        leverage[rows] = np.einsum("ij,ij->j", own, own)
    return np.sqrt(_by_quantity(linear, left, 1 - np.clip(leverage, 0.0, MOST_LEVERAGE)))


def missed(linear: LinearisedModel, left: Array, *, is_last: bool = False) -> Array:
    """Return the share of what a model misses below which no standard error should go, in standard errors as they are.

    Args:
        linear: The campaign.
        left: Shape (m,), whitened residual of the model.
        is_last: Nothing will be added any more: all that it misses is noise, and neighbours that err alike count once.
    """
    if is_last:
        return np.sqrt(_by_quantity(linear, left, np.ones(len(left))))
    return SHARE_OF_MISSES * np.sqrt(_by_quantity(linear, left, np.ones(len(left)), counts_alike=False))


def factors_of(linear: LinearisedModel, left: Array, least: Array | float, *, is_last: bool = False) -> Array:
    """Return by what standard errors change so that they count what a model leaves, shape (2, c).

    Args:
        linear: The campaign.
        left: Shape (m,), whitened residual of the model.
        least: Shape (2, c), standard errors that they have at least, in those of the instruments.
        is_last: As of `missed`.
    """
    return np.maximum(missed(linear, left, is_last=is_last) * linear.inflation, least) / linear.inflation


def are_settled(factors: Array) -> bool:
    """Whether standard errors that change by these factors need not be changed."""
    return bool(np.all((factors < SETTLED) & (factors > 1 / SETTLED)))


def left_by_nuisances(linear: LinearisedModel, white: Array) -> Array:
    """Return what nuisances leave to first order, shape (m,), of a whitened residual with all of them at zero, (m,)."""
    own = linear.jacobian
    return np.asarray(white - own @ np.linalg.solve(own.T @ own + RIDGE * np.eye(own.shape[1]), own.T @ white))


def as_simulated(linear: LinearisedModel, explained: Array, left: Array, share: float) -> Array:
    """Return by how much standard errors are too small where what a model explains is simulated wrong, shape (2, c).

    Such errors change as slowly as what is explained: neighbours that are alike in that count once. They are in what
    the model leaves, for one finding of a few sizes takes away little of them: they are no larger than that.

    Args:
        linear: The campaign.
        explained: Shape (m,), what the model changes, whitened.
        left: Shape (m,), what it leaves, whitened.
        share: Of what it changes, to which it is simulated.
    """
    wrong, missed_by_it = (_by_quantity(linear, one, np.ones(len(one))) for one in (explained, left))
    return np.asarray(np.sqrt(1 + np.minimum(share**2 * wrong, missed_by_it)))


def _by_quantity(linear: LinearisedModel, left: Array, freedom: Array, *, counts_alike: bool = True) -> Array:
    """Return the variance of residuals, shape (m,), of every quantity at rest and in motion, shape (2, c).

    What is known besides, and what an earlier diagnosis knew, is no instrument that could scatter: it is as well known
    as it was stated, or everything that it contradicts could hide in it.
    """
    found = np.ones((2, len(linear.quantities)))
    for c, quantity in enumerate(linear.quantities):
        for kind in (0, 1) if not quantity.is_known else ():
            rows = (linear.kind_of == kind) & (linear.column_of == c)
            if np.count_nonzero(rows) >= FEW:
                together = 1.0
                if kind == 1 and counts_alike:
                    runs = linear.run_of[rows]
                    together = alike([left[rows][runs == run] for run in np.unique(runs)])
                found[kind, c] = together * float(np.sum(left[rows] ** 2) / np.sum(freedom[rows]))
    return found
