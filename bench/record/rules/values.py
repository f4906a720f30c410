"""Single values: there, and possible at all."""

from collections.abc import Iterator

import numpy as np

from bench.record.finding import Finding
from bench.record.rules.sheet import Sheet, rows_where

# No channel of the format reaches this in SI units (1e9 Pa breaks a cylinder, 1e9 s are 32 years), and numbers that
# loggers write for "no value" (1e30, 3.4e38) lie far above. Squares of what is left do not overflow.
IMPOSSIBLE = 1e12

MOST = float(np.finfo(np.float64).max)


def finite(sheet: Sheet) -> Iterator[Finding]:
    """No cell is empty, NaN or infinite. A channel that was not measured has no column at all."""
    for name, values in sheet.run.columns.items():
        if not sheet.within(name, -MOST, MOST) and (rows := rows_where(~np.isfinite(values))):
            remedy = "remove these rows, or the column; a slow instrument repeats its last reading"
            yield sheet.error(name, "no value (empty, NaN or infinite)", remedy, rows)


def plausible(sheet: Sheet) -> Iterator[Finding]:
    """No value is astronomically large."""
    for name, values in sheet.run.columns.items():
        if rows := sheet.rows_outside(name, -IMPOSSIBLE, IMPOSSIBLE):
            yield sheet.error(name, f"{values[rows[0] - 1]:g} is no reading", "remove these rows", rows)
