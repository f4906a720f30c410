"""How much of what the model misses repeats, and how much is new in each recording: two variances for each quantity."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.autocorrelation import FEW, alike
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.record.campaign import Array


@dataclass(frozen=True, eq=False)
class Repeatability:
    """Variances of readings, in units of what the instruments explain; c quantities, at rest and in motion.

    Attributes:
        own: Shape (2, c), new in each recording; 1 at least.
        shared: Shape (2, c), what repeats wherever the state of the machine does.
        pairs: Shape (2, c), readings that were seen in the same state in another recording.
    """

    own: Array
    shared: Array
    pairs: NDArray[np.intp]

    @classmethod
    def of_instruments(cls, c: int) -> "Repeatability":
        """Return that of a model that misses nothing: noise of the instruments, new each time."""
        return cls(np.ones((2, c)), np.zeros((2, c)), np.zeros((2, c), dtype=np.intp))


def row_facts(linear: LinearisedModel) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the kind of every whitened reading (0 at rest, 1 in motion), and its instant, shape (m,) each."""
    c = len(linear.quantities)
    kinds, instants, start = [], [], 0
    for segment, whitening in zip(linear.segments, linear.whitenings, strict=True):
        instants.append(start + np.flatnonzero(whitening.rows) // c)
        kinds.append(np.full(len(whitening.modes), 0 if segment.is_static else 1))
        start += len(segment)
    return np.concatenate(kinds).astype(np.intp), np.concatenate(instants).astype(np.intp)


def repeatability_of(
    linear: LinearisedModel, left: Array, cells: NDArray[np.intp], counted: Repeatability
) -> Repeatability:
    """Return how well readings repeat, by what a model leaves of them.

    What it leaves in one state of the machine in several recordings is compared: the mean is missed every time, the
    deviations from it are new each time. Neighbours that err alike count once.

    Args:
        linear: All recordings.
        left: Shape (m,), whitened instant by instant.
        cells: Shape (T,), the state of every instant.
        counted: What the standard errors count so far.
    """
    kind, instant = row_facts(linear)
    cell = cells[instant]
    own, shared, pairs = np.ones_like(counted.own), np.zeros_like(counted.own), np.zeros_like(counted.pairs)
    for kind_of in (0, 1):
        for c in range(own.shape[1]):
            rows = (kind == kind_of) & (linear.column_of == c)
            if np.count_nonzero(rows) < FEW:
                continue
            new, total, pairs[kind_of, c] = variances(left[rows], cell[rows], linear.run_of[rows])
            own[kind_of, c] = max(counted.own[kind_of, c] * new, 1.0)
            shared[kind_of, c] = max(counted.own[kind_of, c] * total - own[kind_of, c], 0.0)
    return Repeatability(own, shared, pairs)


def variances(left: Array, cell: NDArray[np.intp], run: Array) -> tuple[float, float, int]:
    """Return the variance of what is new in each recording, that of everything, and how many readings have a partner.

    Args:
        left: Shape (n,), what a model leaves of readings, in order of time.
        cell: Shape (n,), the state in which each was made.
        run: Shape (n,), the run of each.
    """
    _, which, count = np.unique(cell, return_inverse=True, return_counts=True)
    has_partner = count[which] > 1
    total = float(np.mean(left**2))
    if np.count_nonzero(has_partner) < FEW:
        return total * alike([left[run == one] for one in np.unique(run)]), total, int(np.count_nonzero(has_partner))
    deviation = left - (np.bincount(which, left) / count)[which]
    degrees = 1 - 1 / count[which]  # of each reading about the mean of its cell
    new = float(np.sum(deviation[has_partner] ** 2) / np.sum(degrees[has_partner]))
    together = alike([deviation[has_partner & (run == one)] for one in np.unique(run)])
    return new * together, total, int(np.count_nonzero(has_partner))
