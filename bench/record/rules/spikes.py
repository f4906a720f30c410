"""Single readings that stand far from those before and after them, or from their repeats: lost, or spoilt."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.rules.labels import STATE
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
CALM = 0.75  # declared: of repeats of a run, at least, are not spoilt; fewer tell their scatter less surely
ALONE = 10.0  # declared: times any other repeat of a state; where several are off, an arm is settling
SOME = 5  # declared: repeats that differ from the median of their state, at least, for their scatter to be known


def no_spikes(sheet: Sheet) -> Iterator[Finding]:
    """In a motion, no reading stands alone, far from the row before and the row after."""
    if sheet.run.kind != "motion" or len(sheet.run) < MANY:
        return
    for column, values in sheet.columns(*QUANTITIES):
        if rows := rows_where(_alone(values, TRAVEL.get(column.unit, 0.0))):
            x = values[rows[0] - 2 : rows[0] + 1]
            message = f"reads {x[1]:.6g} between {x[0]:.6g} and {x[2]:.6g}"
            yield sheet.warning(column.name, message, "lost or spoilt? leave such rows out", rows)


def no_outliers(sheet: Sheet) -> Iterator[Finding]:
    """At rest, no repeat of a state lies far from the others, by what repeats of all states scatter."""
    labels = [sheet.get(name) for name in STATE]
    if sheet.run.kind != "static" or labels[0] is None or labels[2] is None:
        return
    _, state = np.unique(np.stack([label for label in labels if label is not None]), axis=1, return_inverse=True)
    states = np.split(np.argsort(state, kind="stable"), np.cumsum(np.bincount(state))[:-1])
    states = [rows for rows in states if len(rows) > 1]
    if not states:
        return
    every = np.concatenate(states)
    counted = np.concatenate(
        [np.arange(len(rows)) < len(rows) - (len(rows) == 2) for rows in states]
    )  # two are equally off
    for column, values in sheet.columns(*QUANTITIES):
        if not np.isfinite(values).all():
            continue
        usual = np.concatenate([np.full(len(rows), np.median(values[rows])) for rows in states])
        out = np.abs(values[every] - usual)
        scatter = out[counted & (out > 0)]
        if len(scatter) < SOME:
            continue
        times = out / np.quantile(scatter, CALM, method="lower")
        far = _beyond_tails(times) & (out > TRAVEL.get(column.unit, 0.0)) & (out > ALONE * _of_others(out, states))
        if far.all() or not far.any() or out[far].min() <= LARGE * np.ptp(values[every][~far]):
            continue
        rows = np.sort(every[far]) + 1
        message = (
            f"reads {values[rows[0] - 1]:.6g}, and {usual[every == rows[0] - 1][0]:.6g} in the median of its repeats"
        )
        yield sheet.warning(column.name, message, "lost or spoilt? leave such rows out", rows.tolist())


def _of_others(out: Array, states: Sequence[NDArray[np.intp]]) -> Array:
    """Return how far any other repeat of its state is off, for each repeat, shape (n,).

    Args:
        out: Shape (n,), how far each is off, state after state.
        states: Rows of each.
    """
    edges = np.cumsum([len(rows) for rows in states])[:-1]
    parts = np.split(out, edges)
    return np.concatenate([[np.max(np.delete(part, i)) for i in range(len(part))] for part in parts])


def _alone(values: Array, travel: float) -> NDArray[np.bool_]:
    """Return which rows stand out, shape (n,).

    Args:
        values: Shape (n,).
        travel: A change that is nothing.
    """
    step = np.diff(values)
    out = np.where(step[:-1] * step[1:] < 0, np.minimum(np.abs(step[:-1]), np.abs(step[1:])), 0.0)
    far = _more_than_chance(out, np.abs(step))
    if not far.any() or far.all():  # where each row is far from its neighbours none stands alone
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
    rough = out > np.median(size)
    elsewhere = size[~(np.append(rough, False) | np.append(False, rough)) & (size > 0)]
    resolution = float(elsewhere.min()) if len(elsewhere) else float(np.max(size, initial=0.0))
    times = np.zeros_like(out)
    if resolution:
        around = np.lib.stride_tricks.sliding_window_view(np.pad(size, AROUND, mode="reflect"), 2 * AROUND + 2)
        stands = out > 0
        times[stands] = out[stands] / np.maximum(np.median(around[stands], axis=1), resolution)
    return _beyond_tails(times)


def _beyond_tails(times: Array) -> NDArray[np.bool_]:
    """Return which readings stand out, given by how many times the noise each does, shape (n,)."""
    from scipy.special import pdtrc, stdtr  # here: other commands need not wait for it

    order = np.argsort(-times)
    expected = len(times) * 2 * stdtr(TAILS, -times[order])
    more = np.flatnonzero(expected < np.arange(1, len(times) + 1))  # as many as are expected are no rare chance
    told = more[pdtrc(more, expected[more]) < CHANCE]
    far = np.zeros(len(times), dtype=np.bool_)
    far[order[: told[-1] + 1 if len(told) else 0]] = True
    return far
