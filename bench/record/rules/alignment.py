"""Clocks of two records against each other: an effect does not come before its cause."""

from collections.abc import Iterator

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.rules.sheet import Sheet

# Encoder delay and sampling explain 5 ms, the phase lead of a good servo a few more. The motor of an ordinary drive is
# 20 to 100 ms behind its command, never ahead.
LEAD_S = 0.02
SEARCH_S = 0.5
AT_ONCE = 1e5  # numbers; what fits into a processor's cache
N_LAGS = 100  # at most; longer tables are thinned
BETTER = 0.7  # the shift must explain half of the variance of the difference, or the shapes differ for another reason


def leads(sheet: Sheet) -> Iterator[Finding]:
    """In a motion, no motor moves before its command, and both encoders of a joint move together."""
    time = sheet.get("time_s")
    if sheet.run.kind != "motion" or time is None or len(time) < 2 * N_LAGS:
        return
    step = float(np.median(np.diff(time)))
    for column, values in sheet.columns("q_motor", "q_link"):
        source = sheet.joint(column.index, "q_cmd" if column.channel.quantity == "q_motor" else "q_motor")
        if source is None or not sheet.moves(source[0].name) or not sheet.moves(column.name):
            continue
        ahead = _lead(values, source[1], step)
        if ahead > LEAD_S or (ahead < -LEAD_S and column.channel.quantity == "q_link"):
            order = "ahead of" if ahead > 0 else "behind"
            message = f"runs {abs(ahead):.2g} s {order} {source[0].name}"
            yield sheet.warning(column.name, message, "were both recorded by one clock, and is the command complete?")


def _lead(values: Array, source: Array, step: float) -> float:
    """Return by how much `values` is ahead of `source` [s]; 0 where a shift does not explain the difference."""
    every = max(1, round(SEARCH_S / step / N_LAGS))
    values, source, step = values[::every], source[::every], step * every
    span = min(N_LAGS, int(SEARCH_S / step), len(values) // 4)
    middle = slice(span, len(values) - span)
    shifted = sliding_window_view(values, len(values) - 2 * span)[::-1]  # by -span, ..., span samples
    pieces = np.array_split(shifted, np.ceil(shifted.size / AT_ONCE))
    misfits = np.concatenate([np.std(source[middle] - piece, axis=1) for piece in pieces])
    best = int(np.argmin(misfits))
    return (best - span) * step if bool(misfits[best] < BETTER * misfits[span]) else 0.0
