"""Channels that were joined to their labels a row too late or too early: repeats agree under the neighbours' labels."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.rules.labels import STATE
from bench.record.rules.sheet import Sheet

QUANTITIES = ("q_link", "current", "tau_motor", "force", "moment", "reflector", "gas_pressure")
CHANCE = 1e-6  # declared: of a healthy channel of a run to be told, if its repeats differ by noise
TIMES = 10.0  # declared: in variance, beyond what an arm does that settles after its load was hung
SEVERAL = 3  # declared: states that have to say so; of a joint that slipped between two repeats, one or two do
ORDER = {1: ("late", "before"), -1: ("early", "after")}


def rows_keep_their_labels(sheet: Sheet) -> Iterator[Finding]:
    """At rest, no channel's repeats agree far better under the labels of the row before, or of the row after.

    Where a column slipped by a row, one of the repeats of each state is of the state beside it.
    """
    labels = [values for name in STATE if (values := sheet.get(name)) is not None]
    if sheet.run.kind != "static" or not labels or len(sheet.run) < 2:
        return
    ends = np.any(np.diff(np.stack(labels), axis=1) != 0, axis=0)
    for column, values in sheet.columns(*QUANTITIES):
        if slipped := _slip(values, ends):
            late, before = ORDER[slipped]
            message = f"reads a row {late}: repeats of one state agree far better with the labels of the row {before}"
            yield sheet.doubt(column.name, message, "look how the columns were joined to the labels")


def _slip(values: Array, ends: NDArray[np.bool_]) -> int:
    """Return 1 for a channel that agrees far better with the labels of the row before than with its own, -1: after.

    Args:
        values: Shape (n,).
        ends: Shape (n - 1,), whether a state ends with the row.
    """
    from scipy.special import fdtrc  # here: other commands need not wait for it

    both = {1: (values[1:], ends[1:], ends[:-1]), -1: (values[:-1], ends[:-1], ends[1:])}
    for by, (kept, own_ends, other_ends) in both.items():
        (own, own_degrees), (other, other_degrees) = (_scatter(kept, one) for one in (own_ends, other_ends))
        if not min(own_degrees, other_degrees) or np.sum(own > TIMES * other.sum() / other_degrees) < SEVERAL:
            continue
        times = own.sum() / own_degrees / (other.sum() / other_degrees) if other.any() else np.inf
        if times > TIMES and (np.isinf(times) or fdtrc(own_degrees, other_degrees, times) < CHANCE):
            return by
    return 0


def _scatter(values: Array, ends: NDArray[np.bool_]) -> tuple[Array, int]:
    """Return the squares of readings about the means of their states, shape (states,), and all degrees of freedom.

    Args:
        values: Shape (n,).
        ends: Shape (n - 1,), whether a state ends with the row.
    """
    states = np.split(values, np.flatnonzero(ends) + 1)
    return np.array([np.sum((state - state.mean()) ** 2) for state in states]), len(values) - len(states)
