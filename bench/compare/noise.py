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


def repeatability_of(
    linear: LinearisedModel, left: Array, free: Array, cells: NDArray[np.intp], counted: Repeatability
) -> Repeatability:
    """Return how well readings repeat, by what a model leaves of them.

    What it leaves in one state of the machine in several recordings is compared: the mean is missed every time, the
    deviations from it are new each time. Neighbours that err alike count once. What a fit took of the noise is counted
    back: a model with hundreds of free sizes leaves next to nothing of few readings (restricted maximum likelihood).
    A quantity that has less than `FEW` degrees of freedom left shows nothing of its noise, and has that of others of
    its kind.

    Args:
        linear: All recordings.
        left: Shape (m,), whitened instant by instant.
        free: Shape (m,), the degrees of freedom that the fit left each reading.
        cells: Shape (T,), the state of every instant.
        counted: What the standard errors count so far.
    """
    cell = cells[linear.instant_of]
    new, total, pairs = np.ones_like(counted.own), np.ones_like(counted.own), np.zeros_like(counted.pairs)
    degrees = np.zeros_like(counted.own)
    for kind in (0, 1):
        for c in range(new.shape[1]):
            rows = (linear.kind_of == kind) & (linear.column_of == c)
            if np.count_nonzero(rows) < FEW:
                continue
            degrees[kind, c] = np.sum(free[rows])
            if degrees[kind, c] > 0:
                found = variances(left[rows], free[rows], cell[rows], linear.run_of[rows])
                new[kind, c], total[kind, c], pairs[kind, c] = found
    of_kind = np.array([quantity.kind for quantity in linear.quantities])
    for kind, c in np.argwhere(degrees < FEW):
        like = (degrees[kind] >= FEW) & (of_kind == of_kind[c])
        if np.any(like):
            new[kind, c], total[kind, c] = (
                np.average(of[kind, like], weights=degrees[kind, like]) for of in (new, total)
            )
    own = np.maximum(counted.own * new, 1.0)
    return Repeatability(own, np.maximum(counted.own * total - own, 0.0), pairs)


def variances(left: Array, free: Array, cell: NDArray[np.intp], run: Array) -> tuple[float, float, int]:
    """Return the variance of what is new in each recording, that of everything, and how many readings have a partner.

    Args:
        left: Shape (n,), what a model leaves of readings, in order of time.
        free: Shape (n,), the degrees of freedom that the fit left each of them.
        cell: Shape (n,), the state in which each was made.
        run: Shape (n,), the run of each.
    """
    _, which, count = np.unique(cell, return_inverse=True, return_counts=True)
    has_partner = count[which] > 1
    total = float(np.sum(left**2) / np.sum(free))
    degrees = free * (1 - 1 / count[which])  # of each reading about the mean of its cell
    if np.count_nonzero(has_partner) < FEW or not np.any(degrees[has_partner] > 0):
        return total * alike([left[run == one] for one in np.unique(run)]), total, int(np.count_nonzero(has_partner))
    deviation = left - (np.bincount(which, left) / count)[which]
    new = float(np.sum(deviation[has_partner] ** 2) / np.sum(degrees[has_partner]))
    together = alike([deviation[has_partner & (run == one)] for one in np.unique(run)])
    return new * together, total, int(np.count_nonzero(has_partner))
