"""A clock so slow that no inertia shows in its accelerations: minutes for seconds, or the number of a row.

The recording is looked at once more with a clock by which its fastest joint moves as a drive does. Where drives paid
for inertia, that look tells by how much that clock is off, and so by how much the stated one is. A recording that was
slow shows none either way.
"""

from collections.abc import Iterator
from dataclasses import replace

from bench.diagnose.plausibility.drive_looks import Clock, clock_of, drive_looks, resting_torque
from bench.diagnose.plausibility.drive_picture import drive_picture
from bench.diagnose.plausibility.repeated import BINS, Repeated
from bench.diagnose.plausibility.speeds import fastest
from bench.diagnose.replay.segments import segments_of
from bench.errors import ConvergenceError
from bench.record.campaign import Campaign, Run

USUAL = (
    0.3  # effort: of a drive's speed limit, at which the fastest joint is looked at; its clock is estimated from there
)


def slow_clock(repeated: Repeated, level: float) -> Clock | None:
    """Return the rate of a clock that counts more than a second for each second; None where nothing tells.

    Args:
        repeated: The campaign.
        level: Of the interval.
    """
    campaign, compiled, drives = repeated.campaign, repeated.compiled, repeated.drives
    factor = fastest(campaign, compiled) / USUAL
    if not 0 < factor < 1:  # what is faster shows inertia as it is
        return None
    faster = replace(campaign, runs=tuple(_with_clock(campaign, factor)))
    try:
        segments = segments_of(faster, compiled, drives, BINS)
        replay = repeated.replay(segments, drives)
        found = clock_of(drive_looks(drive_picture(replay), resting_torque(replay)), compiled, level)
    except ConvergenceError:
        return None
    if found is None or found.low < factor:
        return None
    return Clock(found.rate / factor, found.low / factor, found.high / factor, found.drives)


def _with_clock(campaign: Campaign, factor: float) -> Iterator[Run]:
    """Yield the runs with the clock of each motion multiplied; readings at rest stay as they are."""
    for run in campaign.runs:
        is_motion = run.kind == "motion"
        columns = {**run.columns, "time_s": factor * run.columns["time_s"]} if is_motion else run.columns
        yield replace(run, columns=columns)
