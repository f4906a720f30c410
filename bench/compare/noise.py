"""How much of what the model misses repeats, and how much is new in each recording: two variances for each quantity."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve, solve_triangular

from bench.compare.autocorrelation import FEW, alike
from bench.compare.joint import Joint
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.record.campaign import Array

MOST_LEVERAGE = 0.9  # of a reading on its own fit; beyond, it says nothing of its scatter (as in `lack_of_fit`)
AT_A_TIME = 1024  # readings whose leverage is found together: memory stays small


@dataclass(frozen=True, eq=False)
class Repeatability:
    """Variances of whitened readings, in units of what the instruments explain; c quantities, at rest and in motion.

    Attributes:
        own: Shape (2, c), new in each recording; 1 at least.
        shared: Shape (2, c), what repeats wherever the state of the machine does.
        pairs: Shape (2, c), readings that were seen in the same state in another recording.
    """

    own: Array
    shared: Array
    pairs: NDArray[np.intp]


def row_facts(linear: LinearisedModel) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the kind of every whitened reading (0 at rest, 1 in motion), and its instant, shape (m,) each."""
    kind = np.concatenate(
        [
            np.full(len(whitening.modes), 0 if segment.is_static else 1)
            for segment, whitening in zip(linear.segments, linear.whitenings, strict=True)
        ]
    )
    c = len(linear.quantities)
    start, instants = 0, []
    for segment, whitening in zip(linear.segments, linear.whitenings, strict=True):
        instants.append(start + np.flatnonzero(whitening.rows) // c)
        start += len(segment)
    return kind.astype(np.intp), np.concatenate(instants).astype(np.intp)


def repeatability_of(joint: Joint, jacobian: Array, columns: Array, cells: NDArray[np.intp]) -> Repeatability:
    """Return how well readings repeat.

    Each recording is fitted by itself with everything that could be added to its model, so nothing that changed
    between two recordings counts as scatter. What is left of it in the same state of two recordings is compared: the
    mean is what the model misses every time, and the deviations from it are new each time.

    Args:
        joint: All recordings, with the standard errors of the instruments.
        jacobian: Shape (m, p), whitened nuisances.
        columns: Shape (m, q), whitened, of everything that could be added, with a prior of one.
        cells: Shape (T,), the state of every instant.
    """
    linear = joint.linear
    kind, instant = row_facts(linear)
    left, freedom = np.empty(len(linear.white)), np.empty(len(linear.white))
    for k in range(len(joint.recordings)):
        rows = np.flatnonzero(joint.of_row == k)
        rich = np.concatenate([jacobian[rows], columns[rows]], axis=1)
        left[rows], freedom[rows] = _left(rich[:, np.any(rich != 0, axis=0)], linear.white[rows])
    c = len(linear.quantities)
    own, shared, pairs = np.ones((2, c)), np.zeros((2, c)), np.zeros((2, c), dtype=np.intp)
    cell = cells[instant]
    for kind_of in (0, 1):
        for column in range(c):
            rows = (kind == kind_of) & (linear.column_of == column)
            if np.count_nonzero(rows) >= FEW:
                found = _variances(left[rows], freedom[rows], cell[rows], linear.run_of[rows], bool(kind_of))
                own[kind_of, column], shared[kind_of, column], pairs[kind_of, column] = found
    return Repeatability(own, shared, pairs)


def scatter_of(linear: LinearisedModel, slopes: Array, white: Array) -> Array:
    """Return the variance of what a model leaves, shape (2, c), for every quantity at rest and in motion.

    What its own fit took away is counted, and neighbours that err alike count once. 1 where a quantity has few readings.

    Args:
        linear: All recordings.
        slopes: Shape (m, p), of everything in the model, with a prior of one.
        white: Shape (m,), residual.
    """
    kind, _ = row_facts(linear)
    left, freedom = _left(slopes, white)
    c = len(linear.quantities)
    found = np.ones((2, c))
    for kind_of in (0, 1):
        for column in range(c):
            rows = (kind == kind_of) & (linear.column_of == column)
            if np.count_nonzero(rows) >= FEW:
                run = linear.run_of[rows]
                together = alike([left[rows][run == one] for one in np.unique(run)])
                found[kind_of, column] = together * float(np.sum(left[rows] ** 2) / np.sum(freedom[rows]))
    return found


def _left(rich: Array, white: Array) -> tuple[Array, Array]:
    """Return what the richest model leaves, and the share of each reading's scatter that its fit left, (m,) each."""
    normal = rich.T @ rich
    normal[np.diag_indices_from(normal)] += 1.0
    root = np.linalg.cholesky(normal)
    left = white - rich @ cho_solve((root, True), rich.T @ white)
    leverage = np.empty(len(white))
    for start in range(0, len(white), AT_A_TIME):
        rows = slice(start, start + AT_A_TIME)
        own = solve_triangular(root, rich[rows].T, lower=True, check_finite=False)
        leverage[rows] = np.einsum("ij,ij->j", own, own)
    return left, 1 - np.clip(leverage, 0.0, MOST_LEVERAGE)


def _variances(
    left: Array, freedom: Array, cell: NDArray[np.intp], run: Array, is_motion: bool
) -> tuple[float, float, int]:
    """Return what is new in each recording, what repeats, and how many readings have a partner."""
    _, which, count = np.unique(cell, return_inverse=True, return_counts=True)
    has_partner = count[which] > 1
    total = float(np.sum(left**2) / np.sum(freedom))
    if np.count_nonzero(has_partner) < FEW:
        together = alike([left[run == one] for one in np.unique(run)]) if is_motion else 1.0
        return max(total * together, 1.0), 0.0, int(np.count_nonzero(has_partner))
    mean = np.bincount(which, left) / count
    deviation = left - mean[which]
    degrees = freedom * (1 - 1 / count[which])  # of each reading about the mean of its cell
    new = float(np.sum(deviation[has_partner] ** 2) / np.sum(degrees[has_partner]))
    if is_motion:
        new *= alike([deviation[has_partner & (run == one)] for one in np.unique(run)])
    new = max(new, 1.0)
    return new, max(total - new, 0.0), int(np.count_nonzero(has_partner))
