"""Channels with another clock: the plant is looked at a while before each reading, and that is what they show."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from bench.effects.effect import Acting
from bench.effects.recorded import Lateness
from bench.hide.pieces import Piece
from bench.simulate.batch import Rows
from bench.simulate.env import CONTROL_PERIOD
from bench.simulate.trace import Array, Trace


@dataclass(frozen=True)
class Late:
    """One quantity that is late; between control periods its truth is taken to be straight.

    Attributes:
        what: Which, and by how much.
    """

    what: Lateness

    def periods(self, read: Rows, piece: Piece) -> Rows:
        """Return the control periods at whose ends the plant has to be looked at, for some that are read."""
        before, _ = self._around(read, piece)
        return np.concatenate([before, np.minimum(before + 1, piece.last - 1)])

    def shown(self, truth: Trace, there: Trace, every: Rows, read: Rows, piece: Piece) -> Trace:
        """Return the truth at the periods that are read with what is late as it was before.

        Args:
            truth: At the periods that are read.
            there: At every period that was looked at.
            every: Those.
            read: Those that are read.
            piece: In which they are.
        """
        before, share = self._around(read, piece)
        values: Array = getattr(there, self.what.field)
        first = values[np.searchsorted(every, before)]
        second = values[np.searchsorted(every, np.minimum(before + 1, piece.last - 1))]
        weight = share.reshape(-1, *np.ones(values.ndim - 1, dtype=int))
        old = (1 - weight) * first + weight * second
        shown: Array = getattr(truth, self.what.field).copy()
        columns = () if self.what.drive is None else (slice(None), self.what.drive)
        shown[columns] = old[columns]
        return replace(truth, **{self.what.field: shown})

    def _around(self, read: Rows, piece: Piece) -> tuple[Rows, Array]:
        """Return the last period before the instants that are shown, and how far in the next one these lie.

        Before a piece begins, and after its last reading, the arm is taken to stand.
        """
        shown = np.clip(read - self.what.seconds / CONTROL_PERIOD, piece.first, piece.last - 1)
        before = np.floor(shown).astype(np.intp)
        return before, shown - before


def late_in(acting: Iterable[Acting]) -> tuple[Late, ...]:
    """Return what is late where some effects act."""
    found = (one.effect.lateness(one.place, one.values) for one in acting)
    return tuple(Late(one) for one in found if one)
