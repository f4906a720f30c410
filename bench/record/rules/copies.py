"""Channels that are one and the same record under two names."""

from collections.abc import Iterator

import numpy as np

from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.rules.sheet import Sheet

DIFFERENT = 10  # values in a column; with fewer, two drives near rest may agree in every row at a coarse resolution
FEW = 100  # rows to look at first


def identical(sheet: Sheet) -> Iterator[Finding]:
    """No two drives read the same numbers, and a moving joint is never exactly where another record of it says.

    At rest it may be: a servo with integral action comes to its command, and a simulation without noise says so.
    Two drives that are commanded alike may move alike.
    """
    for quantity in ("q_motor", "q_link", "current", "tau_motor"):
        rich = [(column, values) for column, values in sheet.columns(quantity) if is_rich(values)]
        for place, (column, values) in enumerate(rich):
            for other, others in rich[:place]:
                if np.array_equal(values, others) and not _commanded_alike(sheet, column.index, other.index):
                    yield sheet.doubt(column.name, f"is a copy of {other.name}", "look which of them was recorded")
                    break
    for quantity, source in (("q_motor", "q_cmd"), ("q_link", "q_cmd"), ("q_link", "q_motor")):
        for column, values in sheet.columns(quantity) if sheet.run.kind == "motion" else ():
            own = sheet.joint(column.index, source)
            if own and np.array_equal(values, own[1]) and is_rich(values):
                yield sheet.doubt(column.name, f"is a copy of {own[0].name}", "record the encoder")


def is_rich(values: Array) -> bool:
    """Return whether there are many different values; a few rows often tell."""
    return len(np.unique(values[:FEW])) >= DIFFERENT or len(np.unique(values)) >= DIFFERENT


def _commanded_alike(sheet: Sheet, first: int, second: int) -> bool:
    one, other = sheet.joint(first, "q_cmd"), sheet.joint(second, "q_cmd")
    return one is not None and other is not None and np.array_equal(one[1], other[1])
