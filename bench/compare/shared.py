"""A whitening in which what the model misses in a state of the machine is the same in every recording.

A quantity that misses d in a state misses d in that state each time, with a variance v (`noise.py`); the covariance of
its readings in one cell is then I + v 1 1'. Where a state is met in several recordings this leaves the differences
between them as they are and takes back what they have in common; where it is met once, v is noise like any other.

What is common to a segment (friction of joints that stand) is whitened after that, for cells tie segments together:
the covariance of tied segments is I + C C', with the modes C of all of them.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array, eye_array
from scipy.sparse.csgraph import connected_components

from bench.compare.noise import Repeatability
from bench.diagnose.linearise.common_modes import modes_of, put_back, take_out
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.noise_covariance import Whitening
from bench.diagnose.replay.instants import at_each_instant
from bench.record.campaign import Array


@dataclass(frozen=True, eq=False)
class SharedWhitening:
    """Takes values that a linearised model whitened on to the space in which what repeats is no news.

    Attributes:
        linear: The model.
        cells: Shape (m, m), takes back what the readings of a cell have in common.
        along: Shape (g, m), what those of each cell have in common, of length one, or none.
        back: Shape (g,), by how much each of the cells is taken back.
        tied: Of each set of tied segments, its rows, orthonormal modes, and by how much these are taken back.
    """

    linear: LinearisedModel
    cells: csr_array
    along: csr_array
    back: Array
    tied: tuple[tuple[NDArray[np.intp], Array, Array], ...]

    def __call__(self, white: Array) -> Array:
        """Return values, shape (m, k), of whitened ones, shape (m, k)."""
        plain = white.copy()
        undo_segments(self.linear, plain)
        return self.of_instants(plain)

    def of_instants(self, values: Array) -> Array:
        """Return values, shape (m, k), of those that were whitened instant by instant, shape (m, k)."""
        found = np.asarray(self.cells @ values, dtype=np.float64)
        for mine, modes, back in self.tied:
            some = found[mine]
            take_out(some, modes, back)
            found[mine] = some
        return found

    def transposed(self, values: Array) -> Array:
        """Return the transpose of `of_instants`, times values, shape (m, k)."""
        found = values.copy()
        for mine, modes, back in self.tied:
            some = found[mine]
            take_out(some, modes, back)
            found[mine] = some
        return np.asarray(self.cells @ found, dtype=np.float64)

    def taken(self, values: Array, rows: NDArray[np.intp]) -> tuple[NDArray[np.intp], Array]:
        """Return what whitening takes from the products of values that some rows alone have.

        Two vectors v and w have the product v' w - (C v)' (C w) when whitened. C has a row for each mode of tied
        segments and for each cell.

        Args:
            values: Shape (n, k), whitened instant by instant.
            rows: Shape (n,).

        Returns:
            Shape (l,), rows of C v that are not zero, and shape (l, k), these.
        """
        parts, which, start = [], [], 0
        for mine, modes, back in self.tied:
            along = np.asarray(self.cells[rows][:, mine] @ modes, dtype=np.float64) * np.sqrt(back * (2 - back))
            here = np.flatnonzero(np.any(along, axis=1))
            if len(here):
                parts.append(along[here].T @ values[here])
                which.append(start + np.arange(len(back)))
            start += len(back)
        along = diags_array(np.sqrt(self.back * (2 - self.back))) @ self.along[:, rows]
        here = np.flatnonzero(abs(along).sum(axis=1))
        return np.concatenate([*which, start + here]), np.concatenate([*parts, along[here] @ values])

    @property
    def log_determinant(self) -> float:
        """Of the whole map from readings, in the place of that which the linearised model counts."""
        common = sum(float(np.sum(np.log(1 - whitening.shrink))) for _, whitening in _segments(self.linear))
        tied = sum(float(np.sum(np.log(1 - back))) for _, _, back in self.tied)
        return float(np.sum(self.linear.log_determinants)) - common + tied + float(np.sum(np.log(1 - self.back)))


def undo_segments(linear: LinearisedModel, white: Array, first: int = 0) -> None:
    """Put what segments have in common back into whitened values, in place.

    Args:
        linear: The model.
        white: Shape (M, k), of whole segments.
        first: Index of the first of these readings among all.
    """
    for part, whitening in _parts(linear, white, first):
        put_back(part, whitening.modes, whitening.shrink)


def settle_segments(linear: LinearisedModel, plain: Array, first: int = 0) -> None:
    """Take what segments have in common out of values that were whitened instant by instant, in place; see above."""
    for part, whitening in _parts(linear, plain, first):
        take_out(part, whitening.modes, whitening.shrink)


def _parts(linear: LinearisedModel, values: Array, first: int) -> Iterator[tuple[Array, Whitening]]:
    """Yield the rows of each whole segment that are among some values, with its whitening."""
    for rows, whitening in _segments(linear):
        if len(rows) and first <= rows[0] < first + len(values):
            yield values[rows[0] - first : rows[-1] + 1 - first], whitening


def shared_whitening(linear: LinearisedModel, repeatability: Repeatability, cells: NDArray[np.intp]) -> SharedWhitening:
    """Return the whitening of a joint model.

    Args:
        linear: All recordings, their standard errors raised by what is new in each.
        repeatability: What repeats, in units of the standard errors before that.
        cells: Shape (T,), the state of every instant.
    """
    kind, instant = linear.kind_of, linear.instant_of
    c = len(linear.quantities)
    sigma = np.concatenate([segment.sigma for segment in linear.weighed]).reshape(-1)[instant * c + linear.column_of]
    share = np.sqrt(repeatability.shared / repeatability.own)[kind, linear.column_of]
    _, group = np.unique(cells[instant] * c + linear.column_of, return_inverse=True)
    mean = np.bincount(group, sigma) / np.bincount(group)
    misses = share * mean[group] / sigma  # of each reading, in its own standard errors
    square = np.bincount(group, misses**2)
    m = len(sigma)
    weights = np.divide(misses, np.sqrt(square[group]), out=np.zeros(m), where=misses > 0)
    along = csr_array((weights, (group, np.arange(m))), shape=(len(square), m))
    back = 1 - 1 / np.sqrt(1 + square)
    settled = csr_array(eye_array(m) - along.T @ (diags_array(back) @ along))  # one pass over many columns
    return SharedWhitening(linear, settled, along, back, tuple(_tied(linear, settled, cells)))


def _tied(
    linear: LinearisedModel, settled: csr_array, cells: NDArray[np.intp]
) -> list[tuple[NDArray[np.intp], Array, Array]]:
    """Return rows, modes and shrinkage of every set of segments that cells tie together."""
    segments = _segments(linear)
    of_instant = at_each_instant(linear.segments, np.arange(len(segments)))
    first = of_instant[cells]  # a cell is named by an instant of it
    count = len(segments)
    ties = csr_array((np.ones(len(cells)), (of_instant, first)), shape=(count, count))
    _, part = connected_components(ties, directed=False)
    found = []
    for one in range(int(part.max()) + 1):
        mine = [segments[i] for i in np.flatnonzero(part == one)]
        rows = np.concatenate([own for own, _ in mine])
        common = np.zeros((len(linear.white), sum(len(whitening.shrink) for _, whitening in mine)))
        start = 0
        for own, whitening in mine:
            size = len(whitening.shrink)
            common[own, start : start + size] = whitening.common
            start += size
        if not start:
            continue
        found.append((rows, *modes_of((settled @ common)[rows])))
    return found


def _segments(linear: LinearisedModel) -> list[tuple[NDArray[np.intp], Whitening]]:
    """Return the rows and the whitening of every segment."""
    edges = np.cumsum([0, *(len(whitening.modes) for whitening in linear.whitenings)])
    rows = [np.arange(start, end) for start, end in itertools.pairwise(edges)]
    return list(zip(rows, linear.whitenings, strict=True))
