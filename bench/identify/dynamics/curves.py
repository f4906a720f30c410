"""Cubic splines of many stretches of motion, read all at once: a call for each takes longer than what it reads."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from bench.record.campaign import Array


@dataclass(frozen=True)
class Curves:
    """Splines, one after the other, with K knots in all, and R rows that read them.

    Attributes:
        knots: Shape (K,) [s].
        pieces: Shape (4, K), coefficients of what begins at each knot, highest power first; none at a spline's last.
        time: Shape (R,) [s], of each row.
        later: Shape (K,) and (R,) [s], what knots and rows are later in a time in which splines follow each other.
        ends: Shape (2, R), first and last piece of the spline that a row reads.
    """

    knots: Array
    pieces: Array
    time: Array
    later: tuple[Array, Array]
    ends: NDArray[np.int64]

    @classmethod
    def of(cls, splines: Sequence[CubicSpline], times: Sequence[Array]) -> "Curves":
        """Return some splines, each with the times of its rows."""
        knots = [spline.x for spline in splines]
        counts, rows = [len(own) for own in knots], [len(own) for own in times]
        starts = np.cumsum([0, *counts])
        later = np.cumsum([0.0, *(float(np.ptp(own)) for own in knots)])[:-1] - [float(own[0]) for own in knots]
        return cls(
            knots=np.concatenate(knots),
            pieces=np.concatenate([np.pad(spline.c, ((0, 0), (0, 1))) for spline in splines], axis=1),
            time=np.concatenate(times),
            later=(np.repeat(later, counts), np.repeat(later, rows)),
            ends=np.repeat([starts[:-1], starts[1:] - 2], rows, axis=1),
        )

    def at(self, delay: float) -> Array:
        """Return what rows read `delay` [s] later, shape (R,); beyond its ends a spline goes on as it is there."""
        time = self.time + delay
        piece = np.searchsorted(self.knots + self.later[0], time + self.later[1], side="right") - 1
        piece = np.clip(piece, *self.ends)
        since, (cubic, square, slope, level) = time - self.knots[piece], self.pieces[:, piece]
        return np.asarray(level + since * (slope + since * (square + since * cubic)))
