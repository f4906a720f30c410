"""Time stamps inside one run."""

from collections.abc import Iterator

import numpy as np

from bench.record.campaign import Array
from bench.record.finding import Finding, counted
from bench.record.moving import FEWEST_ROWS
from bench.record.rules.sheet import Sheet, rows_where

UNEVEN = 0.5  # of the median step; jitter of an ordinary logger stays below, a lost sample makes 1
JITTER = 0.05  # declared: of the median step; time stamps may round, a lost sample may not pass for one
LATE_S = 60.0  # a run may begin with settling; a clock that counts from when the controller was switched on is later
SHORTEST_STEP_S = 1e-5  # [s]; current loops run at 10 to 40 kHz, and no log of a robot has a row for less
UNITS = (("milliseconds", 1e-3), ("microseconds", 1e-6), ("nanoseconds", 1e-9))  # [s]
SAME_RATIO = 0.05  # of what two units of time differ by, at which steps differ by that; jitter of medians stays below
SLOW_STEP_S = 0.5  # samples of a movement come faster than this
# A packet has many samples and next to no time: what an arm does lies between packets. A logger that pauses has whole
# motions.
PAUSE = 10.0  # times the usual step
PACKETS = 3  # pauses, at least
PACKET_ROWS = 250  # of a packet, at most; half a second at 500 Hz
PACKET_TIME = 0.25  # of a run, that its packets take in all at most: samples are four times as far apart as stamped
FEWEST = 10  # rows that count by one before they are taken for row numbers
SLOWEST = {"rad": 1e-3, "m": 1e-4}  # [rad/s], [m/s]; the slowest sweeps for friction are ten times faster


def unit_of(step_s: float) -> str:
    """Return what to say of a clock that seems to go on by so much [s] and is in some other unit."""
    name, factor = next((unit for unit in UNITS if unit[1] * step_s < SLOW_STEP_S), UNITS[-1])
    return f"{name}? multiply by {factor:g}"


def change_of_unit(time: Array) -> tuple[int, float] | None:
    """Return from which row on a clock is in a finer unit than before, and by which factor; None if it is not.

    It jumps there as the clock does that it was: by steps that are 1000 times as long, or a power of that, and to a
    time that is so many times as large.

    Args:
        time: Shape (rows,) [s], of a motion, rising; its first row may have been taken off.
    """
    step = np.diff(time)
    if len(step) < 2 * FEWEST:
        return None
    jump = int(np.argmax(step))
    if min(jump, len(step) - jump - 1) < FEWEST:
        return None
    before, after = float(np.median(step[:jump])), float(np.median(step[jump + 1 :]))
    if not 0 < before < SLOW_STEP_S <= after:
        return None
    for _, factor in UNITS:
        began = (factor * time[jump + 1] - time[jump] - before) / (1 - factor)  # of the clock, where it was taken off
        if abs(after * factor / before - 1) < SAME_RATIO and began > -PAUSE * before:
            return jump + 1, factor
    return None


def out_of_order(time: Array) -> tuple[list[int], list[int]]:
    """Return rows that are ahead of those after them, alone, and rows from which a clock runs backwards; from 1."""
    ahead, back = [], []
    for row in rows_where(np.append(False, np.diff(time) < 0)):
        fits = row < len(time) and (row == 2 or time[row - 1] >= time[row - 3])  # without the row before it
        if fits and time[row - 1] <= time[row] < time[row - 2]:
            ahead.append(row - 1)
        else:
            back.append(row)
    return ahead, back


def is_unsteady(time: Array) -> bool:
    """Whether a clock has uneven steps, and so are most of the others, a little: it is none of the readings' times.

    Where samples are lost, all other steps are even.

    Args:
        time: Shape (rows,) [s], rising.
    """
    step = np.diff(time)
    if len(step) < FEWEST:
        return False
    off = np.abs(step / np.median(step) - 1)
    return bool(np.max(off) > UNEVEN and np.median(off) > JITTER)


def counts_by_one(time: Array) -> bool:
    """Whether a clock goes on by exactly 1 from row to row, as row numbers do."""
    return len(time) >= FEWEST and bool(np.all(np.diff(time) == 1))


def rises(sheet: Sheet) -> Iterator[Finding]:
    """Time never runs back. In a motion it never stands still either; readings at rest may share a time stamp."""
    time = sheet.get("time_s")
    if time is None:
        return
    step = np.diff(time)
    ahead, back = out_of_order(time)
    if ahead:
        message = "is ahead of the rows after it"
        yield sheet.error("time_s", message, "a date among numbers, or a digit too many? write it as the others", ahead)
    if back:
        yield sheet.error("time_s", "runs backwards", "put the rows in order of time", back)
    if sheet.run.kind == "motion" and (same := rows_where(np.append(False, step == 0))):
        yield sheet.error("time_s", "is the same as in the row before", "keep one of each", same)
    elif sheet.run.kind == "motion" and not change_of_unit(time) and (rows := rows_of_a_packet(time)):
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
    if changed := change_of_unit(time):
        row, factor = changed
        message = (
            f"goes on by {np.median(step[row:]):.3g} s from there on and by {np.median(step[: row - 1]):.3g} s before"
        )
        name = next(name for name, one in UNITS if one == factor)
        yield sheet.doubt("time_s", message, f"{name} from there on? multiply by {factor:g} there", [row + 1])
        return
    if rows_of_a_packet(time):
        return
    if uneven := rows_where(np.append(False, np.abs(step - median) > UNEVEN * median)):
        remedy = "times of arrival? give those of reading" if is_unsteady(time) else "look for lost samples"
        yield sheet.warning("time_s", f"is not {median:g} s after the row before", remedy, uneven)
    for column, values in sheet.columns("q_cmd", "q_motor") if median >= SLOW_STEP_S else ():
        fastest = np.max(np.abs(np.diff(values)) / step)
        if sheet.moves(column.name) and fastest < SLOWEST[column.unit]:
            message = f"makes {column.name} creep at {fastest:.2g} {column.unit}/s at most"
            is_count = counts_by_one(time)
            remedy = "row numbers? divide them by the rows that were read in a second" if is_count else unit_of(median)
            yield sheet.doubt("time_s", message, remedy)
            return
