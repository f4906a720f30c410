"""Channels that stand still to the last digit: frozen, clipped, or not connected."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bench.record.campaign import Array
from bench.record.channels import CHANNELS, Column
from bench.record.finding import Finding
from bench.record.rules.sheet import LOAD_N, TRAVEL, Sheet

EFFORT = ("current", "tau_motor")
NOISY = (*EFFORT, "force", "moment", "reflector", "gas_pressure")  # no instrument repeats itself to the last digit
MEASURED = tuple(channel.quantity for channel in CHANNELS if channel.role == "measured")
AT_EXTREME = 5  # equal samples in a row at the largest or smallest value, at least, of a channel without noise
# derived: of noise that repeats itself that often at an extreme; once in 1000 sound sessions of 500 extremes
BY_CHANCE = 2e-6
ANYWHERE = 15  # equal samples in a row at another value: 0.2^14 of 1e5 samples is 2e-5 by chance (see EQUAL)
ROUNDED = 10  # steps; nine, and rounding
# Noise shows in efforts: outside of such stretches few neighbours are equal, and many steps go back on the one before
# (two in three, in theory). Without noise an effort may keep its value at a smooth turning point, and nothing is said.
EQUAL = 0.2
BACK = 0.3
# Noise beside a trend: its second differences change sign from row to row in arccos(-2/3) / pi = 0.73 of all, those of
# a smooth curve hardly ever; rounding alone makes them two steps large at most.
TURNS = 0.6
BY_ROUNDING = 2  # exact: steps


class Cause(NamedTuple):
    """What makes a channel change: name and values of a column, and the change of it that the channel cannot miss."""

    name: str
    values: Array
    enough: float


def frozen_or_saturated(sheet: Sheet) -> Iterator[Finding]:
    """While a joint moves or a load changes, the channel that measures it does not repeat one number.

    Motor torque at rest is left out: the load on a joint may be the same (or zero) in every pose.
    """
    for column, values in sheet.columns("q_motor", "q_link", *EFFORT, "force"):
        cause = _cause(sheet, column)
        is_effort = column.channel.quantity in EFFORT
        if cause is None or len(values) < AT_EXTREME or (is_effort and sheet.run.kind == "static"):
            continue
        low, high = sheet.run.extremes[column.name]
        if high > low:
            if _repeats(values) and (not is_effort or is_noisy(values) or _is_noisy_beside_a_trend(values)):
                yield from _resting(sheet, column.name, values, cause)
        elif np.ptp(cause.values) > cause.enough:
            what = f"is {values[0] + 0.0:g} in every row while {cause.name} changes"
            yield sheet.doubt(column.name, what, "look whether it is connected, or remove it")


def all_frozen(sheet: Sheet) -> Iterator[Finding]:
    """In a motion, not every reading repeats its first row while the clock goes on: instruments are noisy."""
    if sheet.run.kind != "motion" or len(sheet.run) < ANYWHERE:
        return
    ranges = [sheet.run.extremes[column.name] for column, _ in sheet.columns(*MEASURED)]
    reads = any(values[0] != 0 for _, values in sheet.columns(*NOISY))
    if reads and all(low == high for low, high in ranges):
        message = f"every reading of {len(sheet.run)} rows is that of the first row"
        yield sheet.doubt("", message, "was the recording frozen? leave the run out")


def _cause(sheet: Sheet, column: Column) -> Cause | None:
    if column.channel.quantity == "force":
        load = f"load_{column.key}_n"
        return Cause(load, sheet.run.columns[load], LOAD_N) if load in sheet.run.columns else None
    sources = ("q_cmd",) if column.channel.quantity == "q_motor" else ("q_motor", "q_cmd")
    joint = sheet.joint(column.index, *sources)
    return Cause(joint[0].name, joint[1], TRAVEL[joint[0].unit]) if joint else None


def _stretches(values: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return where stretches of equal samples start and end (exclusive)."""
    edges = np.flatnonzero(values[1:] != values[:-1]) + 1
    return np.append(0, edges), np.append(edges, len(values))


def _repeats(values: Array) -> bool:
    """Whether any value comes `AT_EXTREME` times in a row."""
    same = values[1:] == values[:-1]
    return bool(
        np.any(np.logical_and.reduce([same[i : len(same) - AT_EXTREME + 2 + i] for i in range(AT_EXTREME - 1)]))
    )


def is_noisy(values: Array) -> bool:
    """Whether a channel goes up and down from row to row, as noise does; what rests at one value is left out."""
    step = np.sign(_steps(_without_rests(values)))
    turns = step[step != 0]
    return len(turns) > 1 and bool(np.mean(step == 0) < EQUAL and np.mean(turns[1:] != turns[:-1]) > BACK)


def _is_noisy_beside_a_trend(values: Array) -> bool:
    """Whether a channel that rises or falls all the time does so unevenly from row to row, as noise makes it."""
    moving = _without_rests(values)
    bends = _steps(_steps(moving))
    if len(bends) < ANYWHERE or np.mean(_steps(moving) == 0) >= EQUAL:
        return False
    step = finest_step(moving)
    turns = np.sign(bends)[np.abs(bends) > step / 2]
    return bool(np.median(np.abs(bends)) > BY_ROUNDING * step and np.mean(turns[1:] != turns[:-1]) > TURNS)


def finest_step(values: Array) -> float:
    """Return the finest step between readings that differ; 0 where none do."""
    steps = np.diff(np.unique(values))
    return float(steps.min()) if len(steps) else 0.0


def _steps(values: Array) -> Array:
    """Return the steps from row to row; nan between two rows that are infinite, which another rule tells."""
    with np.errstate(invalid="ignore"):
        return np.diff(values)


def _without_rests(values: Array) -> Array:
    """Return a channel with one sample of each stretch in which it rests."""
    starts, ends = _stretches(values)
    length, level = ends - starts, values[starts]
    is_extreme = (level == values.max()) | (level == values.min())
    rests = length >= np.where(is_extreme, AT_EXTREME, ANYWHERE)
    return np.repeat(level, np.where(rests, 1, length))


def _resting(sheet: Sheet, name: str, values: Array, cause: Cause) -> Iterator[Finding]:
    """Look for equal samples in a row during which the cause travels further than it may."""
    starts, ends = _stretches(values)
    length, level = ends - starts, values[starts]
    travel = np.maximum.reduceat(cause.values, starts) - np.minimum.reduceat(cause.values, starts)
    step = finest_step(values)
    many = _more_than_chance(values)
    for extreme, word in ((values.max(), "largest"), (values.min(), "smallest")):
        at = (length >= many) & (level == extreme)
        at[at] = [_is_cut(values, step, start, end) for start, end in zip(starts[at], ends[at], strict=True)]
        if travel[at].sum() > cause.enough:
            message = f"rests at its {word} value {extreme:g} while {cause.name} goes on"
            yield sheet.doubt(name, message, "saturated? widen the range", _rows(starts[at], ends[at]))
    inside = (length >= ANYWHERE) & (travel > cause.enough) & (level > values.min()) & (level < values.max())
    if inside.any():
        message = f"does not change while {cause.name} goes on"
        yield sheet.doubt(name, message, "frozen? look for lost packets", _rows(starts[inside], ends[inside]))


def _more_than_chance(values: Array) -> int:
    """Return how many equal samples in a row at an extreme are more than noise makes.

    Where a share e of neighbours are equal, L in a row are by chance at e^(L - 1), also at the top of a short peak.
    """
    moving = _without_rests(values)
    equal = (np.sum(np.diff(moving) == 0) + 1) / (len(moving) + 1)
    return max(AT_EXTREME, 1 + int(np.ceil(np.log(BY_CHANCE) / np.log(min(equal, EQUAL)))))


def _is_cut(values: Array, step: float, start: int, end: int) -> bool:
    """Whether equal samples at an extreme are more than what rounding makes of the top of a smooth curve.

    A parabola that stays within one step for L samples is nine steps lower L samples further on; one that was cut off
    a step or more below its top has fallen by as much there.
    """
    beyond = values[[max(start - (end - start), 0), min(2 * end - start - 1, len(values) - 1)]]
    return bool(np.max(np.abs(beyond - values[start])) > ROUNDED * step)


def _rows(starts: NDArray[np.intp], ends: NDArray[np.intp]) -> list[int]:
    return [row for start, end in zip(starts.tolist(), ends.tolist(), strict=True) for row in range(start + 1, end + 1)]
