"""How a change may run over the recordings: it comes and stays, it was there once, or it grows from day to day."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.record.campaign import Array

Course = Literal["step", "once", "trend"]
FEWEST_FOR_TREND = 3  # declared: recordings after; with two, a trend is hardly more than two steps


@dataclass(frozen=True, eq=False)
class Profile:
    """One course of a change.

    Attributes:
        course: "step": from one recording on; "once": in one recording only; "trend": growing with time, or with the
            number of the recording where nobody wrote down when they began.
        since: Index of the recording with which it sets in.
        weights: Shape (K,), share of its size in each recording; a trend has all of it in the last.
        days: From its beginning to the last recording; nan unless it is a trend over known times.
    """

    course: Course
    since: int
    weights: Array
    days: float = float("nan")


def profiles_of(n_before: int, days: Array) -> tuple[Profile, ...]:
    """Return every course that a change may have.

    Args:
        n_before: Recordings in which nothing has changed yet.
        days: Shape (K,), when each recording began; nan where that is not known.
    """
    order = np.arange(len(days))
    found = [Profile("step", k, (order >= k).astype(np.float64)) for k in order[n_before:].tolist()]
    found += [Profile("once", k, (order == k).astype(np.float64)) for k in order[n_before:-1].tolist()]
    if len(days) - n_before >= FEWEST_FOR_TREND:
        known = bool(np.all(np.isfinite(days)))
        time = days if known else order.astype(np.float64)
        since = np.where(order < n_before, 0.0, time - np.max(time[:n_before]))
        if since[-1] > 0:
            weights = np.maximum(since, 0.0) / since[-1]
            found.append(Profile("trend", n_before, weights, float(since[-1]) if known else float("nan")))
    return tuple(found)
