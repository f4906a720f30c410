"""Rows that nobody read: a line drawn from the last row before a gap to the first one after it."""

from collections.abc import Iterator

import numpy as np

from bench.record.finding import Finding
from bench.record.rules.sheet import Sheet
from bench.record.rules.stuck import ANYWHERE, BY_ROUNDING, NOISY, ROUNDED, finest_step, is_noisy


@np.errstate(over="ignore", invalid="ignore")  # of readings that are infinite or absurd, which other rules tell
def readings_are_noisy_throughout(sheet: Sheet) -> Iterator[Finding]:
    """In a motion, noisy readings do not lie on a straight line all at once, for more rows than chance makes."""
    if sheet.run.kind != "motion" or len(sheet.run) <= ANYWHERE:
        return
    straight, changes = np.ones(len(sheet.run) - 2, dtype=bool), np.zeros(len(sheet.run) - 2)
    for _, values in sheet.columns(*NOISY):
        step = finest_step(values)
        bends = np.abs(np.diff(values, 2))
        if not step or not is_noisy(values) or np.median(bends) <= ROUNDED * step:
            continue  # rounding may draw a line through so little noise
        straight &= bends <= BY_ROUNDING * step
        changes = np.maximum(changes, np.abs(values[2:] - values[:-2]) / step)
    if not np.any(changes):
        return
    edges = np.diff(straight, prepend=False, append=False).nonzero()[0].reshape(-1, 2)
    filled = [(start, end) for start, end in edges.tolist() if end - start >= ANYWHERE and np.any(changes[start:end])]
    if filled:
        rows = [row for start, end in filled for row in range(start + 2, end + 2)]
        message = f"all readings lie on a straight line without noise for {len(rows)} of {len(sheet.run)} rows"
        yield sheet.warning(
            "", message, "a gap that was filled? leave those rows out, so that nobody fits to them", rows
        )
