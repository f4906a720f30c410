"""Which instants of different recordings are the same state of the machine: there everything that stayed cancels."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bench.diagnose.replay.alike import passes_same, states_of
from bench.diagnose.replay.instants import at_each_instant, instants_of
from bench.diagnose.replay.segments import Segment


def cells_of(segments: Sequence[Segment], recording: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the cell of every instant, shape (T,): instants of one cell are one state, each in another recording.

    A state is where the motors are, how fast they go, what hangs or is bolted on, and from where it was reached. Cells
    grow about the instants of the first recording; one that is met nowhere again has its cell alone.

    Args:
        segments: Of all recordings.
        recording: Shape (S,), index of the recording of each segment.
    """
    states = states_of(segments)
    of_instant = at_each_instant(segments, recording)
    is_static = at_each_instant(segments, [segment.is_static for segment in segments])
    cells = np.arange(len(states))
    for kind in (is_static, ~is_static):
        first = np.flatnonzero(kind & (of_instant == 0))
        if not len(first):
            continue
        tree = cKDTree(states[first])
        for k in range(1, int(np.max(of_instant)) + 1):
            later = np.flatnonzero(kind & (of_instant == k))
            if not len(later):
                continue
            distance, nearest = tree.query(states[later], p=np.inf, distance_upper_bound=1.0)
            _, back = cKDTree(states[later]).query(states[first], p=np.inf, distance_upper_bound=1.0)
            for i in np.flatnonzero(np.isfinite(distance)):
                if back[nearest[i]] == i:  # each is the other's nearest: an instant is counted once
                    cells[later[i]] = first[nearest[i]]
    return np.asarray(cells, dtype=np.intp)


def is_one_program(segments: Sequence[Segment], recording: NDArray[np.intp]) -> bool:
    """Whether every recording repeats the first segment by segment, the greater part of each in the same states.

    What friction holds at rest depends on all that was done before; only then is that the same too.
    """
    every = states_of(segments)
    states = [every[rows] for rows in instants_of(segments)]
    first = np.flatnonzero(recording == 0)
    for k in range(1, int(np.max(recording)) + 1):
        mine = np.flatnonzero(recording == k)
        if len(mine) != len(first):
            return False
        for one, other in zip(mine, first, strict=True):
            if not passes_same(states[one], states[other]):
                return False
    return True
