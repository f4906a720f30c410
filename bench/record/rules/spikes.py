"""Single readings that stand far from those before and after them: lost, or spoilt on the way."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.rules.sheet import TRAVEL, Sheet, rows_where

QUANTITIES = ("q_motor", "q_link", "current", "tau_motor", "force", "moment", "reflector", "gas_pressure")
# Noise of real instruments has tails as of Student's t with about four degrees of freedom (Lange, Little & Taylor,
# Robust statistical modeling using the t distribution, J. Am. Stat. Assoc. 84, 1989); the median step is its scale, or
# a little more.
TAILS = 4.0
CHANCE = 1e-6  # declared: of a healthy channel of a run to be told; a session has a thousand of them
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
    far = _more_than_chance(out, np.abs(step))
    if not far.any():
        return np.zeros(len(values), dtype=np.bool_)
    is_large = out > LARGE * float(np.ptp(values[1:-1][~far]))
    _, which, count = np.unique(values[1:-1][far], return_inverse=True, return_counts=True)
    is_large[far] |= (count >= STANDS_FOR_NONE)[which]
    return np.pad(far & is_large & (out > travel), 1)


def _more_than_chance(out: Array, size: Array) -> NDArray[np.bool_]:
    """Return which of the inner rows stand out by more than as many would by noise, shape (n - 2,).

    One row has to stand out by some two hundred times the noise to be more than its tails, three by twenty times.

    Args:
        out: How far a row stands out of those before and after it, shape (n - 2,).
        size: Steps from row to row, shape (n - 1,).
    """
    from scipy.special import pdtrc, stdtr  # here: other commands need not wait for it

    rough = out > np.median(size)
    elsewhere = size[~(np.append(rough, False) | np.append(False, rough)) & (size > 0)]
    resolution = float(elsewhere.min()) if len(elsewhere) else float(np.max(size, initial=0.0))
    around = np.pad(size, AROUND, mode="reflect")
    noise = np.median(np.lib.stride_tricks.sliding_window_view(around, 2 * AROUND + 2), axis=1)
    times = out / np.maximum(noise, resolution) if resolution else np.zeros_like(out)
    order = np.argsort(-times)
    expected = len(out) * 2 * stdtr(TAILS, -times[order])
    told = np.flatnonzero(pdtrc(np.arange(len(out)), expected) < CHANCE)
    far = np.zeros(len(out), dtype=np.bool_)
    far[order[: told[-1] + 1 if len(told) else 0]] = True
    return far
