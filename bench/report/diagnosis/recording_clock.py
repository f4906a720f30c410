"""The clock of a diagnosis' recording: the runs one after another, without the hours in between."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.record.campaign import Array

LONGEST_STEP = 2.0  # [s], between instants of one segment: dwells and rests need no more to be looked at
BREAK = 1.0  # [s], between segments


@dataclass(frozen=True, eq=False)
class RecordingClock:
    """Times of R frames: T instants, and one frame between any two segments in which curves are cut.

    Attributes:
        seconds: Shape (R,) [s], from 0.
        frame: Shape (R,), index of the instant that is shown; in a break that before it.
        is_break: Shape (R,) bool.
        begins: (seconds, words) at the beginning of every segment.
    """

    seconds: Array
    frame: NDArray[np.int64]
    is_break: NDArray[np.bool_]
    begins: tuple[tuple[float, str], ...]

    def curve(self, values: Array) -> Array:
        """Return a curve over the frames, shape (R,), of values at the instants, shape (T,); nan in the breaks."""
        curve: Array = np.where(self.is_break, np.nan, values[self.frame])
        return curve


def recording_clock_of(linear: LinearisedModel) -> RecordingClock:
    """Return the clock of a campaign."""
    seconds, frame, is_break, begins = [], [], [], []
    now, first = 0.0, 0
    for segment in linear.segments:
        time = segment.motion.time[segment.motion.read]
        if first:
            seconds.append(now + BREAK / 2)
            frame.append(first - 1)
            is_break.append(True)
            now += BREAK
        begins.append((now, f"{segment.label}, at {time[0]:.0f} s of the campaign"))
        clock = now + np.concatenate([[0.0], np.cumsum(np.clip(np.diff(time), 0.0, LONGEST_STEP))])
        seconds += list(clock)
        frame += list(range(first, first + len(segment)))
        is_break += [False] * len(segment)
        now, first = float(clock[-1]), first + len(segment)
    return RecordingClock(
        np.array(seconds), np.array(frame, dtype=np.int64), np.array(is_break, dtype=bool), tuple(begins)
    )
