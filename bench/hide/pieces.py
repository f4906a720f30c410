"""A sitting cut into pieces during which everything slow is taken as constant."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bench.simulate.batch import Course

LONGEST = 60.0  # [s]; in it gears warm by 0.3 K


@dataclass(frozen=True)
class Piece:
    """Control periods `first` to `last` (exclusive) of a course."""

    first: int
    last: int

    def begins(self, course: Course) -> float:
        """Return when it begins, from the beginning of the sitting [s]."""
        return float(course.ends[self.first - 1]) if self.first else 0.0

    def moves(self, course: Course) -> bool:
        """Whether a command or a load changes in it."""
        before = max(self.first - 1, 0)
        here = slice(before, self.last)
        return bool(np.any(np.ptp(course.commands[here], axis=0)) or np.any(np.ptp(course.wrenches[here], axis=0)))


def pieces_of(course: Course) -> tuple[Piece, ...]:
    """Cut a course: a run with the way to it is a piece; a static run that lasts longer than a minute is several."""
    cuts = [0, *_cuts(course), len(course)]
    return tuple(Piece(first, last) for first, last in pairwise(cuts) if last > first)


def _cuts(course: Course) -> Iterator[int]:
    runs = np.array([step.mark.run if step.mark else "" for step in course.steps])
    if not len(runs):
        return
    ends = np.flatnonzero(runs[1:] != runs[:-1])
    begin = 0.0
    for first, last in zip([0, *(ends + 1)], [*ends, len(runs) - 1], strict=True):
        mark = course.steps[first].mark
        read = course.marked[first : last + 1]
        if mark and mark.labels:
            for period in read[:-1]:
                if course.ends[period] - begin > LONGEST - 1e-9:
                    begin = float(course.ends[period])
                    yield int(period) + 1
        begin = float(course.ends[read[-1]])
        if last < len(runs) - 1:
            yield int(read[-1]) + 1
