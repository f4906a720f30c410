"""Where the instants of segments stand among those of all, and what holds at each of them."""

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bench.diagnose.replay.segments import Segment


def recordings_of(segments: Iterable[Segment]) -> tuple[str, ...]:
    """Return the names of the recordings that segments belong to, in order."""
    return tuple(dict.fromkeys(segment.recording for segment in segments))


def slices_of(lengths: Iterable[int]) -> list[slice]:
    """Return where parts of these lengths stand, one after the other."""
    edges = np.cumsum([0, *lengths]).tolist()
    return [slice(first, last) for first, last in pairwise(edges)]


def instants_of(segments: Iterable[Segment]) -> list[slice]:
    """Return where the instants of each segment stand among those of all."""
    return slices_of(map(len, segments))


def at_each_instant(segments: Iterable[Segment], values: ArrayLike) -> NDArray[Any]:
    """Return what holds for each segment, shape (S, ...), at each of its instants, shape (T, ...)."""
    return np.repeat(values, [len(segment) for segment in segments], axis=0)


def run_of_each(segments: Sequence[Segment]) -> NDArray[np.str_]:
    """Return the run of each instant of segments, shape (T,)."""
    return at_each_instant(segments, [segment.run for segment in segments])
