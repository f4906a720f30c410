"""Readings of one clock at the times of another, and what empty cells stand for."""

from collections.abc import Iterator, Mapping
from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from bench.record.campaign import Array
from bench.record.limits import TABLE_CELLS
from bench.record.strict import Strict

ORDER = 4  # of the Butterworth low-pass; forth and back it is of order 8 and delays nothing
SHARE = 0.4  # of the new rate, where the low-pass has lost half of the amplitude; half of the rate is Nyquist's limit
LOST = 3.0  # steps of the log: a longer pause is not bridged (assumed: jitter of a logger stays below one step)
# assumed: times as many readings as are wanted, from which a low-pass comes first; so many rows too many, a warning
FASTER = 1.2
Fill = Literal["hold", "line"]


class Resampling(Strict):
    """A new clock for a log: even, of a stated rate."""

    rate_hz: float = Field(gt=0, description="samples per second")
    cutoff_hz: float | None = Field(None, gt=0, description="of the low-pass before a lower rate; 0.4 times rate_hz")

    @model_validator(mode="after")
    def _cuts_below_nyquist(self) -> "Resampling":
        if self.cutoff_hz is not None and self.cutoff_hz >= self.rate_hz / 2:
            raise ValueError(
                f"cutoff_hz lies above half of rate_hz, {self.rate_hz / 2:g} Hz; give less, or leave it out"
            )
        return self

    def description(self) -> str:
        """Return in words what is done, for the notes of a campaign."""
        cutoff = self.cutoff_hz or SHARE * self.rate_hz
        return (
            f"Resampled to {self.rate_hz:g} Hz by straight lines; from a higher rate after a Butterworth low-pass of "
            f"order {ORDER}, forth and back, {cutoff:g} Hz, on all columns alike."
        )

    def faults(self, columns: Mapping[str, Array]) -> Iterator[tuple[str, str]]:
        """Yield fault and remedy of what cannot be done to a log; nothing is computed yet."""
        time = columns["time_s"]
        length = float(time[-1] - time[0])
        if TABLE_CELLS.exceeded(self.rate_hz * length * len(columns)):
            rows = f"{self.rate_hz:g} Hz make {self.rate_hz * length:.3g} rows of {len(columns)} columns"
            yield f"resample: {rows} of {length:g} s, more than {TABLE_CELLS}", "give a lower rate_hz"
        elif self.rate_hz * length < 1:
            message = f"resample: {self.rate_hz:g} Hz leave one row of {length:g} s"
            least = f"more than {1 / length:.3g}" if length else "a log of more than one row"
            yield message, f"give {least}; rate_hz is in samples per second"
        elif self.cutoff_hz is not None and self.cutoff_hz * length < SHARE:
            message = f"resample: a low-pass of {self.cutoff_hz:g} Hz leaves a mean of {length:g} s"
            yield message, f"give a cutoff_hz of more than {SHARE / length:.3g}, or leave it out"

    def invented(self, time: Array) -> tuple[str, str] | None:
        """Return message and remedy where most rows of the new clock would be no readings, for a log with fewer."""
        step = float(np.median(np.diff(time))) if len(time) > 1 else np.nan
        if not step > 0 or self.rate_hz * step <= FASTER:  # a clock that stands still or falls is a fault
            return None
        own = 1 / step
        message = f"is read {own:.4g} times a second, and made {self.rate_hz:.4g} rows a second by straight lines"
        return (
            message,
            f"give a rate_hz of {own:.4g} at most: rows between readings tell nothing, and count as readings",
        )

    def applied(self, columns: Mapping[str, Array]) -> list[dict[str, Array]]:
        """Return stretches of a log on the new clock; it is cut where samples are lost. `time_s` is the clock.

        Stretches that are shorter than a step of the new clock are left out. `faults` has found nothing.
        """
        time = columns["time_s"]
        others = {name: values for name, values in columns.items() if name != "time_s"}
        found = []
        for rows in _without_pauses(time):
            if len(rows) < 2:
                continue
            first, last = time[rows[0]], time[rows[-1]]
            steps = np.arange(int((last - first) * self.rate_hz * (1 + 1e-12)) + 1)
            even = np.minimum(first + steps / self.rate_hz, last)  # rounding: nobody read anything after the last row
            if len(even) < 2:
                continue
            cut = {name: values[rows] for name, values in others.items()}
            found.append({"time_s": even} | at_times(time[rows], cut, even, self.cutoff_hz))
        return found


def at_times(
    time: Array, columns: Mapping[str, Array], wanted: Array, cutoff_hz: float | None = None
) -> dict[str, Array]:
    """Return columns at other times by straight lines; where fewer are wanted than there are, a low-pass comes first.

    The low-pass is a Butterworth of order 4, forth and back, on an even clock of the log's own rate. All columns pass
    the same one, so what is linear between them stays so.

    Args:
        time: Shape (T,) [s], rising.
        columns: Each of shape (T,).
        wanted: Shape (N,) [s], rising; outside of `time` there is no reading: nan. A single instant has no rate, and
            no low-pass comes before it.
        cutoff_hz: Where it has lost half of the amplitude; None: 0.4 times the wanted rate.
    """
    rate, new = _rate(time), _rate(wanted)
    cutoff = cutoff_hz or SHARE * new
    if rate > FASTER * new and 0 < cutoff < rate / 2 and len(time) > 6 * ORDER:
        even = np.linspace(time[0], time[-1], even_rows(time))
        columns = {name: _low_pass(np.interp(even, time, values), cutoff, rate) for name, values in columns.items()}
        time = even
    outside = np.nan
    return {name: np.interp(wanted, time, values, left=outside, right=outside) for name, values in columns.items()}


def filled(values: Array, how: Fill, time: Array | None) -> Array:
    """Return a column without empty cells: the last reading is repeated, or straight lines join the readings.

    Before its first reading it has that reading's value. A column without any reading stays as it is.
    """
    there = np.flatnonzero(np.isfinite(values))
    if len(there) in (0, len(values)):
        return values
    if how == "line":
        clock = np.arange(len(values), dtype=np.float64) if time is None else time
        return np.interp(clock, clock[there], values[there])
    last = np.maximum.accumulate(np.where(np.isfinite(values), np.arange(len(values)), there[0]))
    return np.asarray(values[last])


def _low_pass(values: Array, cutoff: float, rate: float) -> Array:
    from scipy.signal import butter, sosfiltfilt  # here: half a second that other commands need not wait

    with np.errstate(under="ignore"):
        return np.asarray(sosfiltfilt(butter(ORDER, cutoff, fs=rate, output="sos"), values))


def even_rows(time: Array) -> int:
    """Return how many rows a clock has when its pauses are filled with its own steps."""
    return round(float(time[-1] - time[0]) * _rate(time)) + 1


def _rate(time: Array) -> float:
    return 1 / float(np.median(np.diff(time))) if len(time) > 1 else 0.0


def _without_pauses(time: Array) -> list[np.ndarray]:
    """Return the rows of each stretch in which no samples are lost."""
    step = np.diff(time)
    lost = np.flatnonzero(step > LOST * np.median(step)) if len(step) else np.empty(0, dtype=np.int64)
    return np.split(np.arange(len(time)), lost + 1)
