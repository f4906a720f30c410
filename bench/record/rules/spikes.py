"""Single readings that stand far from those before and after them: lost, or spoilt on the way."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.rules.sheet import TRAVEL, Sheet, rows_where

QUANTITIES = ("q_motor", "q_link", "current", "tau_motor", "force", "moment", "reflector", "gas_pressure")
USUAL = 0.9  # of the rows; up to a tenth of them may be spoilt
# Times what nine rows in ten, and half of those around, stand out by. Of normal noise a row in ten stands out by 1.6 of
# its standard deviation and one in a million by 6, so that is 3.8 times.
FAR = 10.0
AROUND = 10  # rows on either side; a robot that shakes stands out there again and again
LARGE = 0.2  # of the range of all other rows; assumed: what is smaller spoils a mean over several rows by little
STANDS_FOR_NONE = 3  # rows with the same number, which a logger writes where it has none
MANY = 3 * AROUND  # rows of a run


def no_spikes(sheet: Sheet) -> Iterator[Finding]:
    """In a motion, no reading stands alone, far from the row before and the row after."""
    if sheet.run.kind != "motion" or len(sheet.run) < MANY:
        return
    for column, values in sheet.columns(*QUANTITIES):
        if rows := rows_where(_alone(values, TRAVEL.get(column.unit, 0.0))):
            x = values[rows[0] - 2 : rows[0] + 1]
            message = f"reads {x[1]:.6g} between {x[0]:.6g} and {x[2]:.6g}"
            yield sheet.warning(column.name, message, "lost or spoilt? leave such rows out", rows)


def _alone(values: Array, travel: float) -> NDArray[np.bool_]:
    """Return which rows stand out, shape (n,).

    Args:
        values: Shape (n,).
        travel: A change that is nothing.
    """
    step = np.diff(values)
    out = np.where(step[:-1] * step[1:] < 0, np.minimum(np.abs(step[:-1]), np.abs(step[1:])), 0.0)
    far = out > FAR * np.quantile(out, USUAL)
    if not far.any():
        return np.zeros(len(values), dtype=np.bool_)
    size = np.abs(step)
    elsewhere = size[~(np.append(far, False) | np.append(False, far)) & (size > 0)]
    resolution = float(elsewhere.min()) if len(elsewhere) else 0.0
    for row in np.flatnonzero(far):
        around = size[max(row - AROUND, 0) : row + AROUND + 2]
        far[row] = out[row] > FAR * max(resolution, float(np.median(around)))
    others = values[1:-1][~far]
    is_large = out > LARGE * float(np.ptp(others))
    _, which, count = np.unique(values[1:-1][far], return_inverse=True, return_counts=True)
    is_large[far] |= (count >= STANDS_FOR_NONE)[which]
    return np.pad(far & is_large & (out > travel), 1)
