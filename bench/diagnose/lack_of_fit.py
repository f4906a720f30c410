"""What not even the richest model explains is noise too: by how much the standard errors of quantities are too small.

A real drive has cogging, a real arm rings, a clock jitters. One factor for a whole campaign would let the worst channel
drown the others; so each quantity has its own, at rest and in motion. Neighbours that err alike count as one reading.

While a model is still far from the data, signatures are those of a wrong model, good to a share of what it misses: no
quantity counts as known better than half of that. As the climb goes on, standard errors fall to what instruments have.
"""

import numpy as np

from bench.diagnose.design import Design
from bench.record.campaign import Array

RIDGE = 1.0  # the richest model keeps the priors of its columns
MOST_ALIKE = 50  # lags over which the correlation of neighbours is summed
SHARE_OF_MISSES = 0.5  # of what the present model misses, below which no standard error goes
FEW = 10  # readings that say nothing of their own scatter


def lack_of_fit(design: Design, white: Array, columns: Array, prior: Array) -> Array:
    """Return by what the standard errors of every quantity have to be multiplied, shape (2, c): at rest, in motion.

    They never become smaller than what the instruments explain.

    Args:
        design: The campaign.
        white: Shape (m,), residual of the model so far, nuisances at zero.
        columns: Shape (m, q), whitened, of everything that could be added to it.
        prior: Shape (q,), standard deviations of the columns' sizes.
    """
    rich = np.concatenate([design.slopes, columns * prior], axis=1)
    normal = rich.T @ rich
    explained = np.linalg.solve(normal + RIDGE * np.eye(len(normal)), rich.T @ white)
    left = white - rich @ explained
    # what each reading's own fit took away from its scatter
    own = design.slopes
    missed = white - own @ np.linalg.solve(own.T @ own + RIDGE * np.eye(own.shape[1]), own.T @ white)
    inverse = np.linalg.inv(normal + RIDGE * np.eye(len(normal)))
    leverage = np.clip(np.einsum("ij,jk,ik->i", rich, inverse, rich, optimize=True), 0.0, 0.9)
    still = np.array([segment.is_static for segment in design.segments])
    at_rest = np.concatenate([np.full(int(w.rows.sum()), one) for w, one in zip(design.whitenings, still, strict=True)])
    factors = np.ones((2, len(design.quantities)))
    for c in range(len(design.quantities)):
        for kind, rows in enumerate((at_rest & (design.column_of == c), ~at_rest & (design.column_of == c))):
            if np.count_nonzero(rows) < FEW:
                continue
            variance = float(np.sum(left[rows] ** 2) / np.sum(1 - leverage[rows]))
            alike = 1.0 if kind == 0 else _alike(left[rows], design.run_of[rows])
            misses = SHARE_OF_MISSES * np.sqrt(np.mean(missed[rows] ** 2))
            factors[kind, c] = max(np.sqrt(variance * alike), misses)
    return np.maximum(factors * design.excess, 1.0) / design.excess


def _alike(left: Array, run_of: Array) -> float:
    """Return how many neighbours err together: the integrated autocorrelation, summed until it turns negative."""
    sequences = [left[run_of == run] for run in np.unique(run_of)]
    power = sum(float(s @ s) for s in sequences)
    total = 1.0
    for lag in range(1, MOST_ALIKE):
        pairs = sum(float(s[lag:] @ s[:-lag]) for s in sequences if len(s) > lag)
        count = sum(len(s) - lag for s in sequences if len(s) > lag)
        if power <= 0 or count < FEW:
            break
        correlation = pairs / count / (power / len(left))
        if correlation <= 0:
            break
        total += 2 * correlation
    return total
