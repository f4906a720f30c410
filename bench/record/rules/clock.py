"""Time stamps inside one run."""

from collections.abc import Iterator

import numpy as np

from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.rules.sheet import Sheet, rows_where

UNEVEN = 0.5  # of the median step; jitter of an ordinary logger stays below, a lost sample makes 1
LATE_S = 60.0  # a run may begin with settling; a clock that counts from when the controller was switched on is later
SHORTEST_STEP_S = 1e-7  # [s]; no instrument of a robot is read ten million times a second
MILLISECONDS = "milliseconds? multiply by 0.001"
SLOW_STEP_S = 0.5  # samples of a movement come faster than this
FEWEST = 10  # rows that count by one before they are taken for row numbers
SLOWEST = {"rad": 1e-3, "m": 1e-4}  # [rad/s], [m/s]; the slowest sweeps for friction are ten times faster


def counts_by_one(time: Array) -> bool:
    """Whether a clock goes on by exactly 1 from row to row, as row numbers do."""
    return len(time) >= FEWEST and bool(np.all(np.diff(time) == 1))


def rises(sheet: Sheet) -> Iterator[Finding]:
    """Time never runs back. In a motion it never stands still either; readings at rest may share a time stamp."""
    time = sheet.get("time_s")
    if time is None:
        return
    step = np.diff(time)
    if back := rows_where(np.append(False, step < 0)):
        yield sheet.error("time_s", "runs backwards", "put the rows in order of time", back)
    if sheet.run.kind == "motion" and (same := rows_where(np.append(False, step == 0))):
        yield sheet.error("time_s", "is the same as in the row before", "keep one of each", same)
    elif sheet.run.kind == "motion" and len(step) and 0 < (median := float(np.median(step))) < SHORTEST_STEP_S:
        yield sheet.error("time_s", f"goes on by {median:.2g} s from row to row", "give it in seconds")


def is_regular(sheet: Sheet) -> Iterator[Finding]:
    """Time counts from about the first row, in seconds, and a motion is sampled evenly."""
    time = sheet.get("time_s")
    if time is None or len(time) == 0:
        return
    if abs(time[0]) > max(LATE_S, time[-1] - time[0]):
        yield sheet.warning("time_s", f"begins at {time[0]:g} s", "subtract the time of the first row")
    if sheet.run.kind != "motion" or len(time) < 3:
        return
    step = np.diff(time)
    median = float(np.median(step))
    if uneven := rows_where(np.append(False, np.abs(step - median) > UNEVEN * median)):
        yield sheet.warning("time_s", f"is not {median:g} s after the row before", "look for lost samples", uneven)
    for column, values in sheet.columns("q_cmd", "q_motor") if median >= SLOW_STEP_S else ():
        fastest = np.max(np.abs(np.diff(values)) / step)
        if sheet.moves(column.name) and fastest < SLOWEST[column.unit]:
            message = f"makes {column.name} creep at {fastest:.2g} {column.unit}/s at most"
            is_count = counts_by_one(time)
            remedy = "row numbers? divide them by the rows that were read in a second" if is_count else MILLISECONDS
            yield sheet.doubt("time_s", message, remedy)
            return
