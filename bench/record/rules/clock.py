"""Time stamps inside one run."""

from collections.abc import Iterator

import numpy as np

from bench.record.campaign import Array
from bench.record.finding import Finding, counted
from bench.record.moving import FEWEST_ROWS
from bench.record.rules.sheet import Sheet, rows_where

UNEVEN = 0.5  # of the median step; jitter of an ordinary logger stays below, a lost sample makes 1
LATE_S = 60.0  # a run may begin with settling; a clock that counts from when the controller was switched on is later
SHORTEST_STEP_S = 1e-5  # [s]; current loops run at 10 to 40 kHz, and no log of a robot has a row for less
MILLISECONDS = "milliseconds? multiply by 0.001"
SLOW_STEP_S = 0.5  # samples of a movement come faster than this
# A packet has many samples and next to no time: what an arm does lies between packets. A logger that pauses has whole
# motions.
PAUSE = 10.0  # times the usual step
PACKETS = 3  # pauses, at least
PACKET_ROWS = 250  # of a packet, at most; half a second at 500 Hz
PACKET_TIME = 0.25  # of a run, that its packets take in all at most: samples are four times as far apart as stamped
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
    elif sheet.run.kind == "motion" and (rows := rows_of_a_packet(time)):
        steps = f"{np.median(step):.2g} s, and after some {rows} rows by {step.max():.2g} s"
        message = f"goes on by {steps}: samples came in packets"
        remedy = "give the times at which they were taken, such as the controller's, or rows divided by their rate"
        yield sheet.error("time_s", message, remedy)
    elif sheet.run.kind == "motion" and len(step) and 0 < (median := float(np.median(step))) < SHORTEST_STEP_S:
        yield sheet.error("time_s", f"goes on by {median:.2g} s from row to row", "give it in seconds")


def is_long_enough(sheet: Sheet) -> Iterator[Finding]:
    """Rows of a motion are enough to tell a speed."""
    if sheet.run.kind == "motion" and 0 < len(sheet.run) < FEWEST_ROWS:
        message = f"has {counted(len(sheet.run), 'row')}: too few to tell a speed; it is left out"
        yield sheet.warning("", message, f"record {FEWEST_ROWS} at least, or take the run out of campaign.yaml")


def rows_of_a_packet(time: Array) -> int:
    """Return how many samples were stamped when they arrived together, 0 if none were.

    Args:
        time: Shape (rows,) [s], rising.
    """
    step = np.diff(time)
    if len(step) == 0:
        return 0
    pauses = step > PAUSE * np.median(step)
    count = int(np.count_nonzero(pauses))
    rows = round(len(time) / (count + 1))
    is_packet = count >= PACKETS and rows <= PACKET_ROWS and step[~pauses].sum() < PACKET_TIME * step.sum()
    return rows if is_packet else 0


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
    if rows_of_a_packet(time):
        return
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
