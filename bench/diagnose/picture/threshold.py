"""How much evidence chance alone produces: the declared false-alarm rate, over everything that was tried at once."""

from collections.abc import Sequence

import numpy as np
from scipy.linalg import solve_triangular

from bench.diagnose.picture.marginal import Marginal
from bench.record.campaign import Array

DRAWS = 4000
LEAST = 4.6  # log Bayes factor (100 to 1) that is asked for even where chance alone would not come near it


def family_threshold(
    marginal: Marginal, blocks: Sequence[tuple[Array, Array]], rate: float, rng: np.random.Generator
) -> float:
    """Return the log evidence that the best of all blocks exceeds by chance in a share `rate` of null campaigns.

    Args:
        marginal: Products of the campaign.
        blocks: Columns and prior of everything that is tried.
        rate: Declared false-alarm rate.
        rng: For the null campaigns, which are drawn in the space of the scores.
    """
    information = marginal.information
    values, vectors = np.linalg.eigh(information)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    scores = rng.standard_normal((DRAWS, len(values))) @ root.T
    best = np.full(DRAWS, -np.inf)
    single = [(int(columns[0]), float(prior[0])) for columns, prior in blocks if len(columns) == 1]
    if single:
        which, sigma = (np.array(part) for part in zip(*single, strict=True))
        scale = 1 + sigma**2 * np.diagonal(information)[which]
        evidence = scores[:, which] ** 2 * (0.5 * sigma**2 / scale) - 0.5 * np.log(scale)
        np.maximum(best, evidence.max(axis=1), out=best)
    for columns, prior in blocks:
        if len(columns) == 1:
            continue
        h = information[np.ix_(columns, columns)]
        factor = np.linalg.cholesky(np.eye(len(columns)) + prior[:, None] * h * prior)
        b = solve_triangular(factor, (scores[:, columns] * prior).T, lower=True)
        evidence = 0.5 * np.einsum("ij,ij->j", b, b) - float(np.sum(np.log(np.diag(factor))))
        np.maximum(best, evidence, out=best)
    return max(float(np.quantile(best, 1 - rate)), LEAST)
