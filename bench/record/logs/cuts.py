"""What of a log becomes runs: windows of time, and where a long log is split."""

from collections.abc import Iterator, Mapping
from itertools import pairwise

import numpy as np
from pydantic import Field, model_validator

from bench.errors import InputError
from bench.record.campaign import Array
from bench.record.channels import columns_of
from bench.record.rules.sheet import TRAVEL
from bench.record.strict import Strict

STILL = 0.1  # of what counts as a movement at all (`TRAVEL`: 0.01 rad, 2 mm): 1 mrad or 0.2 mm while it stands; assumed
FEWEST = 2  # rows of a run


class Cuts(Strict):
    """Times are seconds after the first row of a log, as a `time_s` that begins with zero shows them."""

    windows_s: tuple[tuple[float, float], ...] = Field((), description="only this, [from, to]; each a run of its own")
    split_at_s: tuple[float, ...] = Field((), description="a run ends and another begins there")
    split_at_rest_s: float | None = Field(None, gt=0, description="a run ends where all joints stand still so long [s]")

    @model_validator(mode="after")
    def _are_in_order(self) -> "Cuts":
        turned = [w for w in self.windows_s if not 0 <= w[0] < w[1]]
        more = f", and {len(turned) - 1} more likewise" if len(turned) > 1 else ""
        problems = [f"windows_s: {turned[0][0]:g} is not before {turned[0][1]:g}{more}"] if turned else []
        over = [(a, b) for a, b in pairwise(self.windows_s) if b[0] < a[1]]
        if over:
            a, b = over[0]
            more = f", and {len(over) - 1} more likewise" if len(over) > 1 else ""
            problems.append(f"windows_s: {list(b)} begins before {list(a)} has ended{more}; a row belongs to one run")
        if any(b <= a for a, b in pairwise((0.0, *self.split_at_s))):
            problems.append("split_at_s: write times above zero in rising order")
        if problems:
            raise ValueError("; ".join(problems))
        return self

    @property
    def cuts_nothing(self) -> bool:
        """Whether a log becomes one run as it is."""
        return not (self.windows_s or self.split_at_s or self.split_at_rest_s)

    def windows(self, time: Array) -> list[slice]:
        """Return the rows of each window that is stated; time rises."""
        found = []
        for begin, end in self.windows_s:
            rows = np.flatnonzero((time >= begin) & (time <= end))
            found.append(slice(int(rows[0]), int(rows[-1]) + 1) if len(rows) else slice(0, 0))
        return found

    def split(self, columns: Mapping[str, Array]) -> Iterator[slice]:
        """Yield the rows of each run of a window; `time_s` counts from the first row of the log."""
        time = columns["time_s"]
        borders = [0, *np.searchsorted(time, self.split_at_s).tolist(), len(time)]
        for begin, end in pairwise(sorted(set(borders))):
            if self.split_at_rest_s is None:
                pieces = [slice(begin, end)]
            else:
                pieces = split_at_rest({n: v[begin:end] for n, v in columns.items()}, self.split_at_rest_s)
                pieces = [slice(piece.start + begin, piece.stop + begin) for piece in pieces]
            yield from (piece for piece in pieces if piece.stop - piece.start >= FEWEST)


def split_at_rest(columns: Mapping[str, Array], rest_s: float) -> list[slice]:
    """Return the rows of each movement; of a rest that is longer than `rest_s`, half of that stays at either side.

    A joint stands still for as long as it stays within 1 mrad (0.2 mm of a slide). Encoders tell, and commands of
    joints that have none.
    """
    time = columns["time_s"]
    positions = columns_of(columns, "q_motor") or columns_of(columns, "q_link") or columns_of(columns, "q_cmd")
    if not positions or len(time) < FEWEST:
        return [slice(0, len(time))]
    from scipy.ndimage import maximum_filter1d, minimum_filter1d  # here: other commands need not wait for it

    n = max(round(rest_s / float(np.median(np.diff(time)))), 1) + 1  # rows of a rest
    if n > len(time):
        return [slice(0, len(time))]
    rests = np.ones(len(time) - n + 1, dtype=np.bool_)  # whether one begins in a row
    for column in positions:
        values = columns[column.name]
        spread = maximum_filter1d(values, n) - minimum_filter1d(values, n)
        rests &= spread[n // 2 : n // 2 + len(rests)] <= STILL * TRAVEL[column.unit]
    begun = np.zeros(len(time) + 1, dtype=np.int64)
    begun[: len(rests)] += rests
    begun[n : n + len(rests)] -= rests
    stands = np.cumsum(begun[:-1]) > 0
    moves = np.flatnonzero(~stands)
    found = []
    for group in np.split(moves, np.flatnonzero(np.diff(moves) > 1) + 1) if len(moves) else []:
        begin = int(np.searchsorted(time, time[group[0]] - rest_s / 2))
        end = int(np.searchsorted(time, time[group[-1]] + rest_s / 2, side="right"))
        found.append(slice(max(begin, 0), min(end, len(time))))
    return found


def in_window(cuts: Cuts, window: tuple[float, float]) -> Cuts:
    """Return cuts with another window.

    Raises:
        InputError: It is empty.
    """
    if not 0 <= window[0] < window[1]:
        raise InputError(
            f"--window-s {window[0]:g} {window[1]:g}: write FROM before TO, in seconds after the first row."
        )
    return cuts.model_copy(update={"windows_s": (window,)})
