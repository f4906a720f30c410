"""Angles and readings of a log brought to one slow clock, on which the model is held against them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.identify.directions import Flags
from bench.record.campaign import Array
from bench.record.look.families import Family
from bench.record.look.values import evenly
from bench.report.log_look.lines import Line

EDGE = 5  # samples at either end, which the low-pass sees past
SHORTEST = 40  # samples that are left, less than a second; eight parts of five tell the scatter of a factor (assumed)


@dataclass(frozen=True)
class Slow:
    """A log at 50 Hz, without what is faster than 20 Hz.

    Attributes:
        time: Shape (T,) [s], even.
        angles: The line of each drive's angle, of the encoder or else of the command.
        position: Shape (T, n), as these lines have it.
        readings: Columns as listed by a family, of which some move -> shape (T, n), as logged.
        moves: The same columns -> shape (n,), whether each moves.
    """

    time: Array
    angles: tuple[Line, ...]
    position: Array
    readings: Mapping[tuple[str, ...], Array]
    moves: Mapping[tuple[str, ...], Flags]


def slow_motion(
    lines: Sequence[Line], families: Sequence[Family], time: Array, columns: Mapping[str, Array], n: int
) -> Slow | None:
    """Return a log on a slow clock; None where a drive has no angle, or the log is too short."""
    angles = _angles(lines, n)
    if angles is None:
        return None
    names = dict.fromkeys(
        name for group in ([a.source for a in angles], *(f.sources for f in families)) for name in group
    )
    clock, slow = evenly(time, {name: columns[name] for name in names})
    position = np.stack([line.factor * slow[line.source] + line.offset for line in angles], axis=1)[EDGE:-EDGE]
    if len(position) < SHORTEST:
        return None
    stacked = {f.sources: np.stack([slow[name] for name in f.sources], axis=1)[EDGE:-EDGE] for f in families}
    # by the column itself: the low-pass leaves roundings of one that stands still
    moves = {
        f.sources: np.array([np.ptp(columns[name]) > 0 for name in f.sources])
        & (np.ptp(stacked[f.sources], axis=0) > 0)
        for f in families
    }
    moves = {sources: flags for sources, flags in moves.items() if np.any(flags)}
    return Slow(clock[EDGE:-EDGE], tuple(angles), position, {sources: stacked[sources] for sources in moves}, moves)


def _angles(lines: Sequence[Line], n: int) -> list[Line] | None:
    """Return the line of each drive's angle, of the encoder or else of the command; None if a drive has none."""
    places = {line.column: line for line in lines}
    found = []
    for number in range(1, n + 1):
        names = [f"{quantity}_{number}_{unit}" for quantity in ("q_motor", "q_cmd") for unit in ("rad", "m")]
        found += [places[name] for name in names if name in places][:1]
    return found if len(found) == n else None
