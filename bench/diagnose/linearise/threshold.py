"""How much evidence chance alone produces: the declared false-alarm rate, over everything that was tried at once."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.blas import strmm

from bench.diagnose.linearise.marginal import Marginal
from bench.record.campaign import Array

DRAWS = 4000  # effort: null campaigns; the 99th percentile of so many is known to a tenth of a nat
AT_A_TIME = 500  # effort: draws: memory stays small
LEAST = 4.6  # declared: log Bayes factor (100 to 1) that is asked for even where chance alone would not come near it


def family_threshold(
    marginal: Marginal, blocks: Sequence[tuple[Array, Array, float]], rate: float, rng: np.random.Generator
) -> float:
    """Return the log evidence that the best of all blocks exceeds by chance in a share `rate` of null campaigns.

    Args:
        marginal: Products of the campaign.
        blocks: Columns and prior of everything that is tried, and the logarithm of its share of the prior odds. That a
            size has one sign only is left out: it halves how often chance passes, and doubles the evidence.
        rate: Declared false-alarm rate.
        rng: For the null campaigns, which are drawn in the space of the scores.
    """
    information = marginal.information
    # Columns may be copies of each other, and little may be left of one beside what is known. Each product is rounded
    # by the last digit of what it was before that was taken out; q of those at most is what a q x q matrix lacks.
    squares = np.maximum(marginal.columns.squares, 1.0)
    lifted = information + len(squares) * np.finfo(np.float64).eps * np.diag(squares)
    root = np.asfortranarray(np.linalg.cholesky(lifted), dtype=np.float32)  # digits enough for chance
    single, several = _shaped(information, blocks)
    best = np.full(DRAWS, -np.inf)
    for start in range(0, DRAWS, AT_A_TIME):
        drawn = rng.standard_normal((min(AT_A_TIME, DRAWS - start), len(root)), dtype=np.float32)
        scores = strmm(1.0, root, drawn.T, lower=1).T
        mine = best[start : start + AT_A_TIME]
        if len(single.columns):
            evidence = scores[:, single.columns] ** 2 * single.weights - single.costs
            np.maximum(mine, evidence.max(axis=1), out=mine)
        for group in several:
            b = np.matmul(scores[:, group.columns].transpose(1, 0, 2), group.weights)
            evidence = 0.5 * np.einsum("eij,eij->ei", b, b) - group.costs[:, None]
            np.maximum(mine, evidence.max(axis=0), out=mine)
    return max(float(np.quantile(best, 1 - rate)), LEAST)


@dataclass(frozen=True, eq=False)
class _Group:
    """E blocks of k columns each, whose evidence for scores s is |W s|^2 / 2 less a cost.

    Attributes:
        columns: Shape (E, k); (E,) for blocks of one column.
        weights: Shape (E, k, k), transposes of W; (E,), halves of the squares of W for blocks of one column.
        costs: Shape (E,).
    """

    columns: NDArray[np.int64]
    weights: NDArray[np.float32]
    costs: Array


def _shaped(information: Array, blocks: Sequence[tuple[Array, Array, float]]) -> tuple[_Group, list[_Group]]:
    """Return the blocks of one column, and the others grouped by their numbers of columns."""
    by_size: dict[int, list[tuple[Array, Array, float]]] = {}
    for block in blocks:
        by_size.setdefault(len(block[0]), []).append(block)
    groups = {}
    for k, alike in by_size.items():
        columns, prior, share = (np.stack(part) for part in zip(*alike, strict=True))
        h = information[columns[:, :, None], columns[:, None, :]]
        factor = np.linalg.cholesky(np.eye(k) + prior[:, :, None] * h * prior[:, None, :])
        weights = np.linalg.inv(factor) * prior[:, None, :]
        costs = np.sum(np.log(np.diagonal(factor, axis1=1, axis2=2)), axis=1) - share
        groups[k] = _Group(columns, weights.transpose(0, 2, 1).astype(np.float32), costs)
    none = _Group(np.empty((0, 1), dtype=np.int64), np.empty((0, 1, 1), dtype=np.float32), np.empty(0))
    one = groups.pop(1, none)
    return _Group(one.columns[:, 0], 0.5 * one.weights[:, 0, 0] ** 2, one.costs), list(groups.values())
