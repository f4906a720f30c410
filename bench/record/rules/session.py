"""What must hold between the runs of one campaign."""

from collections import defaultdict
from collections.abc import Hashable, Iterator, Sequence
from itertools import pairwise

import numpy as np

from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.rules.approach import approach_is_felt
from bench.record.rules.clock import counts_by_one
from bench.record.rules.copies import read_for_themselves
from bench.record.rules.out_of_line import places_in_line
from bench.record.rules.repeated_runs import no_run_twice
from bench.record.rules.shared_rows import no_rows_twice
from bench.record.rules.sheet import TRAVEL, Sheet
from bench.record.rules.weights import weights_are_masses

ROUNDING_S = 1.0  # dates of files come in whole seconds
YEAR_S = 3.2e7
OFTEN = 5.0  # times as often are other motions read, of which one that is read once a second stands out
AIR_IN_FAHRENHEIT = (273.15 + 50, 273.15 + 95)  # exact: 10 to 35 degrees Celsius, as Fahrenheit taken for Celsius [K]
SLOWER = 0.1  # of the speed of the others; it is no slow sweep, for it is read as slowly as it moves


def examine_session(sheets: Sequence[Sheet]) -> list[Finding]:
    """Put the runs of one campaign, or of several of one machine, through the rules together."""
    return [
        *begins_in_time(sheets),
        *no_overlap(sheets),
        *no_row_numbers(sheets),
        *no_run_twice(sheets),
        *no_rows_twice(sheets),
        *read_for_themselves(sheets),
        *approach_is_felt(sheets),
        *weights_are_masses(sheets),
        *one_pose_everywhere(sheets),
        *gas_begins_cool(sheets),
        *places_in_line(sheets),
    ]


def begins_in_time(sheets: Sequence[Sheet]) -> Iterator[Finding]:
    """Each run starts within a year of the one before, the first one of the recording's start."""
    recording, before = None, 0.0
    for sheet in sorted(sheets, key=lambda sheet: (sheet.run.recording, sheet.run.start_s)):
        if sheet.run.recording != recording:
            recording, before = sheet.run.recording, 0.0
        start, since = sheet.run.start_s, "the run before" if before else "the start of its recording"
        if start - before > YEAR_S:
            message = f"starts {start:g} s, {(start - before) / YEAR_S:.2g} years, after {since}"
            remedy = (
                "milliseconds, or since 1970? write start_s into campaign.yaml in seconds since the recording began"
            )
            yield sheet.doubt("start_s", message, remedy)
        before = start


def no_overlap(sheets: Sequence[Sheet]) -> Iterator[Finding]:
    """One robot does one run at a time, and the clock of a recording does not begin anew."""
    for before, after in pairwise(sorted(sheets, key=lambda sheet: (sheet.run.recording, sheet.run.start_s))):
        if before.run.recording != after.run.recording:
            continue
        time = before.get("time_s")
        end = before.run.start_s + (float(time[-1]) if time is not None and len(time) else 0.0)
        if end > after.run.start_s + ROUNDING_S:
            message = f"ends at {end:g} s, after {after.run.name!r} began at {after.run.start_s:g} s"
            remedy = "correct start_s; two instruments' logs of one movement belong into one table"
            yield before.warning("time_s", message, remedy)


def no_row_numbers(sheets: Sequence[Sheet]) -> Iterator[Finding]:
    """No clock of a motion counts its rows.

    One that goes on by exactly a second a row is doubted where other motions are read much more often, and where it
    lasts into the next run or moves as much more slowly than they do.
    """
    motions = [sheet for sheet in sheets if sheet.run.kind == "motion" and "time_s" in sheet.run.columns]
    motions = [sheet for sheet in motions if _rises(sheet.run.columns["time_s"])]  # else it is an error
    counted = [sheet for sheet in motions if counts_by_one(sheet.run.columns["time_s"])]
    often = [sheet for sheet in motions if OFTEN * _step(sheet) <= 1]
    if not often:
        return
    for sheet in counted:
        other = min(often, key=_step)
        later = [one.run.start_s for one in sheets if one.run.recording == sheet.run.recording]
        later = [start for start in later if start > sheet.run.start_s]
        overlaps = bool(later) and sheet.run.start_s + len(sheet.run) - 1 > min(later) + ROUNDING_S
        if overlaps or _speed(sheet) < SLOWER * max(map(_speed, often)):
            message = f"counts rows, by 1 from row to row; that of {other.file} goes on by {_step(other):.3g} s"
            yield sheet.doubt("time_s", message, "row numbers? divide them by the rows that were read in a second")


def _rises(time: Array) -> bool:
    return bool(np.all(time[1:] > time[:-1]))


def _step(sheet: Sheet) -> float:
    step = np.diff(sheet.run.columns["time_s"])
    return float(np.median(step)) if len(step) else np.inf


def _speed(sheet: Sheet) -> float:
    """Return the largest speed of any joint, hinge or slide, from row to row."""
    step = np.diff(sheet.run.columns["time_s"])
    moved = (np.max(np.abs(np.diff(values)) / step, initial=0) for _, values in sheet.columns("q_cmd", "q_motor"))
    return float(max(moved, default=0.0))


def one_pose_everywhere(sheets: Sequence[Sheet]) -> Iterator[Finding]:
    """Joints are all the same in a pose that two runs number alike, or several are not: then each counts for itself."""
    seen: dict[Hashable, list[tuple[Sheet, dict[str, float]]]] = defaultdict(list)
    for sheet in sheets:
        pose, angles = sheet.get("pose"), [*sheet.columns("q_motor")] or [*sheet.columns("q_cmd")]
        if sheet.run.kind == "static" and pose is not None:
            for number in np.unique(pose[np.isfinite(pose)]):
                at = {column.name: float(np.median(values[pose == number])) for column, values in angles}
                seen[sheet.run.recording, float(number)].append((sheet, at))
    for visits in seen.values():
        (first, there), *others = visits
        for sheet, at in others:
            both = at.keys() & there.keys()
            apart = [name for name in both if abs(at[name] - there[name]) > TRAVEL[name.rsplit("_", 1)[1]]]
            if len(apart) == 1 < len(both):
                (name,) = apart
                message = f"is {at[name]:.4g} here and {there[name]:.4g} in run {first.run.name!r}, in one pose"
                remedy = "all other joints are the same; was an angle written down wrong? else number poses by angles"
                yield sheet.warning(name, message, remedy)


def gas_begins_cool(sheets: Sequence[Sheet]) -> Iterator[Finding]:
    """In the first run of a recording, gas is not as hot as air in degrees Fahrenheit that were taken for Celsius."""
    for recording in dict.fromkeys(sheet.run.recording for sheet in sheets):
        first = min((one for one in sheets if one.run.recording == recording), key=lambda one: one.run.start_s)
        gas = first.get("gas_temperature_k")
        if gas is not None and len(gas) and AIR_IN_FAHRENHEIT[0] < np.median(gas) < AIR_IN_FAHRENHEIT[1]:
            message = f"is {np.median(gas):.4g} K, {np.median(gas) - 273.15:.3g} degrees Celsius, from the first run on"
            yield first.warning("gas_temperature_k", message, "degrees Fahrenheit? (F - 32) 5/9 + 273.15 is K")
