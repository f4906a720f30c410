"""What must hold between the runs of one campaign."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

from bench.record.finding import Finding
from bench.record.rules.repeated_runs import no_run_twice
from bench.record.rules.sheet import Sheet

ROUNDING_S = 1.0  # dates of files come in whole seconds


def examine_session(sheets: Sequence[Sheet]) -> list[Finding]:
    """Put the runs of one campaign, or of several of one machine, through the rules together."""
    return [*no_overlap(sheets), *no_run_twice(sheets)]


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
