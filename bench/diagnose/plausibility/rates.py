"""How fast readings change."""

from collections.abc import Sequence

import numpy as np

from bench.diagnose.replay.instants import instants_of
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array

LEAST = 3  # exact: readings that have a rate in their middle


def rates_of(segments: Sequence[Segment], values: Array, over: float = 0.0) -> Array:
    """Return how fast values change, shape (T, c); nan at rest and in motions of less than three readings.

    Args:
        segments: Of T instants.
        values: Shape (T, c).
        over: Time before each instant over which the change is taken [s]; 0: the rate at the instant.
    """
    rates = np.full_like(values, np.nan)
    for segment, rows in zip(segments, instants_of(segments), strict=True):
        if segment.is_static or len(segment) < LEAST:
            continue
        time = segment.motion.time[segment.motion.read]
        if over == 0.0:
            rates[rows] = np.gradient(values[rows], time, axis=0)
            continue
        for c, column in enumerate(values[rows].T):
            rates[rows, c] = (column - np.interp(time - over, time, column)) / over
    return rates
