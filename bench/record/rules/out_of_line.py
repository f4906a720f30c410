"""Single places of a reflector out of the line that its other readings make, by the tails of all of them.

In a motion a place is held against the cubic through two rows before and two after it; at rest against the median of
its repeats. What is told is beyond two tails: that of real instruments' noise, by its scale (`spikes.TAILS`), and that
of the campaign itself, where an arm is jerked or sways. Of sizes X_1 > X_2 > ... whose tail falls exponentially,
i (X_i - X_(i+1)) are independent and alike (Renyi, On the theory of order statistics, Acta Math. Acad. Sci. Hung. 4,
1953), so the one below the k largest, over the sum of those below it, says how likely such a gap is by chance.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.rules.clock import UNEVEN
from bench.record.rules.labels import STATE
from bench.record.rules.sheet import Sheet
from bench.record.rules.spikes import ALONE, AROUND, TAILS

CUBIC = np.array([1.0, -4.0, 6.0, -4.0, 1.0]) / 6  # exact: a row less the cubic through two before and two after it
SPIKE = CUBIC  # exact: what one row that is off by one makes of five rows around it
JERK = np.array([0.0, -0.5, 1.0, -0.5, 0.0])  # exact: what a speed that changes at once makes of them
MEDIAN = 1.538  # exact: of the length of three normal errors, in standard deviations of one
GAPS = 20  # declared: below those in question, that tell the tail; fewer than all, for only the tail is alike
MOST = 5  # declared: places out of line that a campaign may have; more are told as something else, or not at all
CHANCE = 1e-3  # declared: of a healthy reflector of a campaign to be told
REPEATS = 4  # of a state, at least: of three, two agree now and then while an arm sways


@dataclass(frozen=True, eq=False)
class _Places:
    """Places of a reflector in a run that are held against others; m of them.

    Attributes:
        sheet: The run.
        rows: Shape (m,), from 1.
        off: Shape (m,) [m], how far from where the others have each.
        times: Shape (m,), the same in what is usual around it; at rest in metres.
        left: Shape (m,), the same of the others around it once that one place is put right.
        alone: Shape (m,), whether one place out of line explains more than a motion that is jerked or settles.
    """

    sheet: Sheet
    rows: NDArray[np.intp]
    off: Array
    times: Array
    left: Array
    alone: NDArray[np.bool_]


def places_in_line(sheets: Sequence[Sheet]) -> Iterator[Finding]:
    """No single place of a reflector stands out further than the tails of all its places reach."""
    for reflector in sorted({c.name[: -len("_x_m")] for sheet in sheets for c, _ in sheet.columns("reflector")}):
        for held in (_beside_neighbours, _beside_repeats):
            found = [places for sheet in sheets if (places := held(sheet, reflector)) is not None]
            times = np.concatenate([np.zeros(0), *(places.times for places in found)])
            middle = float(np.median(times[times > 0])) if held is _beside_repeats and times.any() else 1.0
            least, usual = _more_than_chance(times / middle)
            for places in found:
                far = (places.times >= middle * least) & (places.left <= middle * usual) & places.alone
                if far.any():
                    size = 1e3 * float(places.off[far].max())
                    message = f"is {size:.3g} mm out of the line of the readings around it"
                    rows = np.sort(places.rows[far]).tolist()
                    yield places.sheet.warning(reflector, message, "lost or spoilt? leave such rows out", rows)


def _more_than_chance(times: Array) -> tuple[float, float]:
    """Return the least of the sizes that stand out by more than chance, and the largest that do not.

    Args:
        times: Shape (m,), sizes, in medians of them.

    Returns:
        inf and 0 where none does.
    """
    from scipy.special import stdtr  # here: other commands need not wait for it

    largest = np.sort(times[times > 0])[::-1][: MOST + GAPS + 1]
    gaps = np.arange(1, len(largest)) * (largest[:-1] - largest[1:])
    for k in range(min(MOST, len(gaps) - GAPS), 0, -1):
        by_noise = 3 * len(times) * 2 * stdtr(TAILS, -MEDIAN * largest[k - 1])  # of three axes
        below = float(gaps[k : k + GAPS].sum())
        if by_noise < CHANCE and below > 0 and MOST * (1 + gaps[k - 1] / below) ** -GAPS < CHANCE:
            return float(largest[k - 1]), float(largest[k])
    return np.inf, 0.0


def _beside_neighbours(sheet: Sheet, reflector: str) -> _Places | None:
    """Return places of a motion, each the farthest off among its neighbours."""
    time, place = sheet.get("time_s"), _place(sheet, reflector)
    if sheet.run.kind != "motion" or time is None or place is None or len(place) < 2 * AROUND + len(CUBIC):
        return None
    step = np.diff(time)
    error = np.tensordot(_windows(place), CUBIC, axes=(2, 0))
    off = np.linalg.norm(error, axis=1)
    uneven = np.abs(step - np.median(step)) > UNEVEN * np.median(step)
    off[sliding_window_view(uneven, len(CUBIC) - 1).any(axis=1)] = 0.0
    usual = np.median(sliding_window_view(np.pad(off, AROUND, mode="reflect"), 2 * AROUND + 1), axis=1)
    usual = np.maximum(usual, np.median(off))
    if not usual.all():  # an instrument that repeats its last reading
        return None
    around = _windows(np.pad(error, ((2, 2), (0, 0))))
    spike, jerk = (around - error[:, :, None] * shape for shape in (SPIKE, JERK))
    sizes = np.linalg.norm(around, axis=1)
    left, left_of_jerk = (np.linalg.norm(rest, axis=1).max(axis=1) for rest in (spike, jerk))
    top = (off > 0) & (off >= sizes.max(axis=1))
    rows = np.flatnonzero(top) + 1 + len(CUBIC) // 2
    return _Places(sheet, rows, off[top], (off / usual)[top], (left / usual)[top], (left < left_of_jerk)[top])


def _windows(values: Array) -> Array:
    """Return each five rows of values, shape (n - 4, 3, 5)."""
    return sliding_window_view(values, len(CUBIC), axis=0)


def _beside_repeats(sheet: Sheet, reflector: str) -> _Places | None:
    """Return places of a static run, of each state the farthest from the median."""
    labels, place = [sheet.get(name) for name in STATE], _place(sheet, reflector)
    if sheet.run.kind != "static" or labels[0] is None or labels[2] is None or place is None:
        return None
    states = np.unique(np.stack([label for label in labels if label is not None]), axis=1, return_inverse=True)[1]
    found = []
    for state in range(states.max(initial=-1) + 1):
        rows = np.flatnonzero(states == state)
        if len(rows) >= REPEATS:
            off = np.linalg.norm(place[rows] - np.median(place[rows], axis=0), axis=1)
            first = int(np.argmax(off))
            found.append((rows[first] + 1, off[first], np.delete(off, first).max()))
    if not found:
        return None
    rows, off, left = map(np.array, zip(*found, strict=True))
    return _Places(sheet, rows, off, off, left, off > ALONE * left)


def _place(sheet: Sheet, reflector: str) -> Array | None:
    """Return where a reflector was, shape (n_rows, 3) [m]; None where an axis is missing or has no number."""
    axes = [sheet.get(f"{reflector}_{axis}_m") for axis in "xyz"]
    if any(axis is None or not np.isfinite(axis).all() for axis in axes):
        return None
    return np.stack([axis for axis in axes if axis is not None], axis=1)
