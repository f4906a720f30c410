"""Counters of joints that stand some whole turns on: as continuous joints have them after a while."""

import numpy as np

from bench.record.campaign import Array

TURN = 2 * np.pi  # [rad]
ROUNDED = 1e-3  # rounding: of a range of a turn, as files write it


def whole_turns(angle: Array, lower: float, upper: float, beside: float) -> int:
    """Return how many turns a counter is on, by its first sample; 0 where that does not bring it into the range.

    A joint with less than a turn to go has no such counter.

    Args:
        angle: Shape (T,) [rad], numbers alone.
        lower: End of the joint's range [rad].
        upper: Its other end [rad].
        beside: How far an angle may lie beside them [rad].
    """
    if not len(angle) or upper - lower < TURN * (1 - ROUNDED):
        return 0
    turns = round(float(angle[0]) / TURN)
    low, high = float(np.min(angle)) - turns * TURN, float(np.max(angle)) - turns * TURN
    return turns if low >= lower - beside and high <= upper + beside else 0


def as_offset(turns: int) -> float:
    """Return what takes turns away from an angle [rad]."""
    return -turns * TURN


def in_words(turns: int) -> str:
    """Return "a counter that stands 3 turns on"."""
    return f"a counter that stands {abs(turns)} turn{'s' if abs(turns) > 1 else ''} {'on' if turns > 0 else 'back'}"
