"""What the values of columns tell where names do not: a clock, a derivative, a command that comes first."""

from collections.abc import Mapping, Sequence

import numpy as np

from bench.record.campaign import Array
from bench.record.logs.resample import at_times, filled
from bench.record.look.families import Family
from bench.record.rules.values import IMPOSSIBLE

LOOK_RATE = 50.0  # [Hz] at which columns are compared; arms move below 5 Hz (assumed)
MOST = 6000  # samples that are compared: two minutes
DERIVATIVE = 0.95  # correlation of a column with the slope of another from which it is its velocity (assumed; noise of
# differentiated encoders at 50 Hz leaves 0.99, another joint's velocity 0.5)
SLOPES = (0.8, 1.25)  # between a velocity and a slope in the same unit (assumed; other units lie a factor of 57 away)
SMOOTH = 0.01  # share of a column that is faster than 20 Hz: less in encoders, more in currents (assumed)
HUGE = IMPOSSIBLE  # no instrument reads more
PAUSE = 1000  # steps; a log that is interrupted for so long is looked at up to there (assumed)
ALIKE = 0.1  # of its own spread, by which a command differs from what it commands (assumed; following errors are 1 %)


def clock_of(columns: Mapping[str, Array], preferred: Sequence[str]) -> str | None:
    """Return the column that rises evenly; one with a preferred name if it rises, else the first that is no counter."""
    finite = {name: values for name, values in columns.items() if len(values) > 2 and np.all(np.isfinite(values))}
    rising = [name for name, values in finite.items() if np.all(np.diff(values) > 0) and _is_even(values)]
    named = [name for name in preferred if name in rising]
    others = [name for name in rising if not np.all(np.diff(columns[name]) == 1)]
    return next(iter((*named, *others)), None)


def clock_factor(values: Array, unit: str) -> tuple[float, str]:
    """Return the factor from a clock to seconds, and why."""
    stated = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
    step = float(np.median(np.diff(values)))
    if unit in stated:
        return stated[unit], f"unit {unit} in its name"
    for name, factor, most in (("s", 1.0, 0.5), ("ms", 1e-3, 500.0), ("us", 1e-6, 5e5), ("ns", 1e-9, np.inf)):
        if step < most:
            return factor, f"its steps of {step:g} are taken as {name}: {1 / (step * factor):.4g} Hz"
    raise AssertionError("steps are finite")


def evenly(time: Array, columns: Mapping[str, Array]) -> tuple[Array, dict[str, Array]]:
    """Return a clock of 50 Hz and columns on it, low-passed at 20 Hz; two minutes, or up to a pause."""
    steps = np.diff(time)
    ends = np.flatnonzero((time[1:] > time[0] + MOST / LOOK_RATE) | (steps > PAUSE * np.median(steps)))
    rows = slice(0, int(ends[0]) + 1 if len(ends) else len(time))
    time = time[rows]
    even = np.arange(float(time[0]), float(time[-1]), 1 / LOOK_RATE)
    return even, at_times(time, {name: values[rows] for name, values in columns.items()}, even)


def without_holes(values: Array, time: Array) -> Array:
    """Return a column with straight lines where it has no number, or one that no instrument reads."""
    return filled(np.where(np.abs(values) < HUGE, values, np.nan), "line", time)


def readable(values: Array) -> Array:
    """Return a column as an instrument can have read it: zero where all of it is less than any resolves."""
    return values if np.max(np.abs(values)) > 1 / HUGE else 0 * values


def moving(columns: Mapping[str, Array]) -> list[str]:
    """Return the columns that are numbers throughout and do not stand still."""
    return [name for name, values in columns.items() if np.max(np.abs(values)) < HUGE and np.ptp(values) > 0]


def families_by_value(time: Array, columns: Mapping[str, Array], n: int | None) -> list[Family]:
    """Return what values tell of columns in the order of the log.

    A velocity is the slope of a position. Without velocities, positions are smooth. What is left over in blocks of one
    column for each drive is unknown.

    Args:
        time: Shape (T,) [s].
        columns: Without the clock.
        n: Number of drives, if the robot is known.
    """
    order = [name for name in columns if name in set(moving(columns)) and not _counts(columns[name])]
    clock, slow = evenly(time, {name: columns[name] for name in order})
    if not order or len(clock) < 10:
        return []
    slope_of = _slopes(slow, order)
    positions = [name for name in order if name in slope_of and name not in slope_of.values()]
    why = "each is followed by its own slope"
    if not positions:
        positions = [name for name in order if _roughness(time, columns[name], clock, slow[name]) < SMOOTH]
        why = "smooth, as encoders are"
    blocks = _blocks(order, positions, n or _count(slow, positions))
    found = [Family("position", False, block, "", why) for block in blocks]
    found = _commands(found, slow)
    taken = {name for family in found for name in family.sources}
    for family in list(found):
        speeds = tuple(slope_of[name] for name in family.sources if name in slope_of)
        if speeds and not taken & set(speeds):
            found.append(Family("velocity", family.is_command, speeds, "", f"slope of {family.shown}"))
            taken |= set(speeds)
    accelerations = {slope_of[name] for name in taken if name in slope_of} - taken
    rest = [name for name in order if name not in taken | accelerations]
    size = len(found[0].sources) if found else n
    found += [Family("unknown", False, block, "", "moves with the robot") for block in _blocks(order, rest, size)]
    return found


def _slopes(slow: Mapping[str, Array], order: Sequence[str]) -> dict[str, str]:
    """Return column -> the column that is its slope in time."""
    slopes = np.stack([np.gradient(slow[name], 1 / LOOK_RATE) for name in order])
    values = np.stack([slow[name] for name in order])
    slopes, values = slopes[:, 5:-5] - slopes[:, 5:-5].mean(axis=1, keepdims=True), values[:, 5:-5]
    values = values - values.mean(axis=1, keepdims=True)
    sizes = np.sqrt(np.sum(slopes**2, axis=1)), np.sqrt(np.sum(values**2, axis=1))
    product = slopes @ values.T
    correlation = product / np.maximum(np.outer(*sizes), np.finfo(float).tiny)
    ratio = product / np.maximum(sizes[0][:, None] ** 2, np.finfo(float).tiny)
    np.fill_diagonal(correlation, 0.0)
    correlation[(ratio < SLOPES[0]) | (ratio > SLOPES[1])] = 0.0
    best = np.argmax(correlation, axis=1)
    return {order[i]: order[j] for i, j in enumerate(best) if correlation[i, j] > DERIVATIVE}


def _blocks(order: Sequence[str], wanted: Sequence[str], n: int | None) -> list[tuple[str, ...]]:
    """Return neighbouring columns in blocks of n; those of a run that makes no whole block are left out."""
    runs: list[list[str]] = []
    last = -2
    for name in wanted:
        place = order.index(name)
        if place == last + 1 and runs:
            runs[-1].append(name)
        else:
            runs.append([name])
        last = place
    size = n or max((len(run) for run in runs), default=1)
    return [tuple(run[i : i + size]) for run in runs for i in range(0, len(run) - size + 1, size)]


def _count(slow: Mapping[str, Array], positions: Sequence[str]) -> int | None:
    """Return the number of drives where positions stand twice, commanded and measured; None if they do not."""
    for n in range(1, len(positions) // 2 + 1):
        if all(_alike(slow[a], slow[b]) for a, b in zip(positions[:n], positions[n : 2 * n], strict=True)):
            return n
    return None


def _commands(positions: Sequence[Family], slow: Mapping[str, Array]) -> list[Family]:
    """Of two families of positions that are alike, return the one that comes first as commanded."""
    if len(positions) < 2:
        return list(positions)
    one, other = positions[:2]
    pairs = [(slow[a], slow[b]) for a, b in zip(one.sources, other.sources, strict=True)]
    if not all(_alike(a, b) for a, b in pairs):
        return list(positions)
    ahead = float(np.mean([_leads(a, b) for a, b in pairs]))
    first, second = (one, other) if ahead >= 0 else (other, one)
    command = Family("position", True, first.sources, "", f"ahead of {second.shown} by {1e3 * abs(ahead):.2g} ms")
    measured = Family("position", False, second.sources, "", f"{second.why}; behind {first.shown}")
    return [command, measured, *positions[2:]]


def _leads(first: Array, second: Array) -> float:
    """Return by how much one column is ahead of another [s], to first order."""
    slope = np.gradient(second, 1 / LOOK_RATE)
    return float(np.dot(first - second, slope) / max(float(np.dot(slope, slope)), np.finfo(float).tiny))


def _alike(first: Array, second: Array) -> bool:
    return bool(np.std(first - second) < ALIKE * np.std(second))


def _roughness(time: Array, values: Array, clock: Array, slow: Array) -> float:
    """Return the share of a column that is faster than its low-passed course; infinite where that is all edge."""
    fast = values - np.interp(time, clock, slow)
    inner = (time > clock[5]) & (time < clock[-5])
    if not np.any(inner):
        return np.inf
    return float(np.std(fast[inner]) / max(float(np.std(values[inner])), np.finfo(float).tiny))


def _is_even(values: Array) -> bool:
    step = np.diff(values)
    return bool(np.mean(np.abs(step - np.median(step)) < np.median(step)) > 0.9)  # jitter and lost samples are few


def _counts(values: Array) -> bool:
    return bool(np.all(np.diff(values) > 0) and _is_even(values))
