"""Rows that stand in two motions: logs that overlap, or one that was cut out of the other; they would count twice."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bench.record.channels import columns_of
from bench.record.finding import Finding
from bench.record.rules.copies import is_rich
from bench.record.rules.sheet import Sheet
from bench.record.rules.stuck import NOISY, is_noisy

# derived: rows in a row that read the same in two runs; where noise is rounded so coarsely that it repeats itself every
# third time, that many come by chance once in 1e14 pairs of rows
FEWEST = 30
MIXED = 0.7548776662466927  # any irrational number: with its powers as weights unequal rows have unequal sums


def no_rows_twice(sheets: Sequence[Sheet]) -> Iterator[Finding]:
    """No row of a motion reads as one of another motion does, however alike the robot moved: instruments are noisy."""
    groups: dict[tuple[str, ...], list[tuple[Sheet, NDArray[np.float64]]]] = {}
    for sheet in sheets:
        columns = sheet.run.columns
        names = tuple(sorted(column.name for column in columns_of(columns, *NOISY)))
        if sheet.run.kind != "motion" or not any(is_rich(columns[name]) and is_noisy(columns[name]) for name in names):
            continue
        sums = np.zeros(len(sheet.run))
        for name in names:
            sums = MIXED * sums + columns[name]
        groups.setdefault(names, []).append((sheet, sums))
    for group in groups.values():
        yield from _shared(group)


def _shared(group: Sequence[tuple[Sheet, NDArray[np.float64]]]) -> Iterator[Finding]:
    """Yield a doubt for each motion of which rows in a row stand in one before it.

    Args:
        group: Motions with the same columns, and a number for each of their rows that tells it from others.
    """
    sums = np.concatenate([of for _, of in group])
    owner = np.repeat(np.arange(len(group)), [len(of) for _, of in group])
    row = np.concatenate([np.arange(len(of)) for _, of in group])
    order = np.argsort(sums, kind="stable")  # of equals the first run comes first
    one, other = order[:-1], order[1:]
    same = (sums[one] == sums[other]) & (owner[one] != owner[other])
    pairs = np.stack([owner[one], owner[other], row[other] - row[one], row[one]], axis=1)[same]
    pairs = pairs[np.lexsort(pairs.T[::-1])]
    goes_on = np.all(np.diff(pairs, axis=0) == (0, 0, 0, 1), axis=1)
    edges = np.concatenate([[0], np.flatnonzero(~goes_on) + 1, [len(pairs)]])
    longest: dict[int, tuple[int, int]] = {}  # of a run: rows in a row, and the first of the pairs
    for begin, end in pairwise(edges.tolist()):
        if end - begin >= FEWEST:
            later = int(pairs[begin, 1])
            longest[later] = max(longest.get(later, (0, 0)), (end - begin, begin))
    for later, (count, begin) in longest.items():
        (first, others), (sheet, own) = group[pairs[begin, 0]], group[later]
        is_whole = len(own) == len(others) == count
        if not is_whole and first.file != sheet.file:  # a whole copy is told by `no_run_twice`
            lag, at = int(pairs[begin, 2]), int(pairs[begin, 3])
            message = f"{count} rows from row {at + lag + 1} on read as {first.file} does from row {at + 1} on"
            yield sheet.doubt("", message, "do the logs overlap? cut one of them; what stands in both counts twice")
