"""Everything of all recordings, whitened instant by instant: other noise is another factor for each instant.

What may act takes long to find and to whiten, and its columns are hundreds of megabytes. With other standard errors, or
another scatter of friction, nothing of that changes but the factor F of each instant (`noise_covariance.py:
Whitening`), so what was whitened by F is multiplied by F' inv(F).
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from bench.compare.joint import Joint
from bench.compare.levels import Slopes, by_level
from bench.compare.shared import undo_segments
from bench.diagnose.linearise.candidates import Candidate
from bench.diagnose.linearise.generic import Block
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.screening import Entry, Tried, tried_of
from bench.errors import InputError
from bench.record.campaign import Array

TOGETHER = 64  # effort: instants that are multiplied at once; memory stays small


@dataclass(frozen=True, eq=False)
class ByInstant:
    """All recordings and what may act in them, whitened instant by instant; m readings, q columns.

    Attributes:
        joint: The recordings.
        residual: Shape (m,), of the nominal model.
        slopes: Of what may be off, the machine's and each recording's.
        entries: Every cause and every free shape, each with its columns.
        columns: Shape (m, q), what they change if they act in all recordings alike.
        discrepancy: Shape (m, d), what they change where they stayed: the same array without a large change.
        prior: Shape (d,), standard deviations of these sizes.
    """

    joint: Joint
    residual: Array
    slopes: Slopes
    entries: tuple[Entry, ...]
    columns: Array
    discrepancy: Array
    prior: Array

    @classmethod
    def of(cls, joint: Joint) -> Self:
        """Return all that may act in some recordings.

        Raises:
            InputError: Nothing of the catalogue would leave a trace.
        """
        tried = _tried(joint.tried())
        stayed = _tried(joint.discrepancy()) if joint.large else tried
        for one in {id(some): some for some in (tried, stayed)}.values():
            undo_segments(joint.linear, one.columns.matrix)
        columns, discrepancy = tried.columns.matrix, stayed.columns.matrix
        residual, slopes = _of_model(joint, joint.linear)
        return cls(joint, residual, slopes, tried.entries, columns, discrepancy, stayed.prior)

    def again(self, linear: LinearisedModel) -> Self:
        """Return the same with the noise of another linearised model of the same readings."""
        if linear is self.joint.linear:
            return self
        old, new = (np.concatenate([one.factors for one in model.whitenings]) for model in (self.joint.linear, linear))
        turn = np.linalg.solve(old.transpose(0, 2, 1), new.transpose(0, 2, 1)).transpose(0, 2, 1)
        place = linear.instant_of * new.shape[1] + linear.column_of
        columns = _turned(self.columns, turn, place)
        is_same = self.discrepancy is self.columns
        joint = replace(self.joint, linear=linear)
        residual, slopes = _of_model(joint, linear)
        return replace(
            self,
            joint=joint,
            residual=residual,
            slopes=slopes,
            columns=columns,
            discrepancy=columns if is_same else _turned(self.discrepancy, turn, place),
        )

    def stayed(self, rows: slice) -> Array:
        """Return what may be off and the discrepancy, each with a prior of one, of some readings, shape (n, p + d)."""
        slopes, discrepancy = self.slopes.matrix[rows], self.discrepancy[rows]
        every = np.empty((len(slopes), slopes.shape[1] + discrepancy.shape[1]))
        every[:, : slopes.shape[1]] = slopes
        np.multiply(discrepancy, self.prior, out=every[:, slopes.shape[1] :])
        return every


def _of_model(joint: Joint, linear: LinearisedModel) -> tuple[Array, Slopes]:
    """Return the residual and the slopes of a linearised model."""
    residual = linear.white[:, None].copy()
    slopes = by_level(linear.jacobian, linear.nuisances, joint.of_row, linear.scatter.new)
    for values in (residual, slopes.matrix):
        undo_segments(linear, values)
    return residual[:, 0], slopes


def _turned(values: Array, turn: Array, place: NDArray[np.intp]) -> Array:
    """Return values, shape (m, k), with another factor for each instant.

    Args:
        values: Shape (m, k).
        turn: Shape (T, c, c).
        place: Shape (m,), rising, of each reading among the T c that there may be.
    """
    length, c, _ = turn.shape
    found = np.empty_like(values)
    for start in range(0, length, TOGETHER):
        some = turn[start : start + TOGETHER]
        rows = slice(*np.searchsorted(place, (start * c, (start + len(some)) * c)).tolist())
        here = place[rows] - start * c
        every = np.zeros((len(some) * c, values.shape[1]))
        every[here] = values[rows]
        found[rows] = (some @ every.reshape(len(some), c, -1)).reshape(len(every), -1)[here]
    return found


def _tried(what: tuple[Candidate | Block, ...]) -> Tried:
    """Return everything that may act.

    Raises:
        InputError: There is nothing.
    """
    if not what:
        raise InputError(
            "nothing of the catalogue would leave a trace in these recordings: log motor currents or torques, a "
            "reflector, a link encoder, or the gas pressure, beside the motor angles."
        )
    return tried_of(what)
