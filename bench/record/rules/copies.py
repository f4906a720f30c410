"""Channels that are one and the same record under two names."""

from collections import defaultdict
from collections.abc import Iterator, Sequence, Set
from itertools import combinations

import numpy as np

from bench.record.campaign import Array
from bench.record.channels import Column
from bench.record.finding import Finding, counted
from bench.record.possible import TEMPERATURES
from bench.record.rules.labels import STATE
from bench.record.rules.sheet import Sheet
from bench.record.rules.stuck import EFFORT, NOISY, is_noisy

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


def read_for_themselves(sheets: Sequence[Sheet]) -> Iterator[Finding]:
    """No instrument reads another one's numbers, or a load as stated, to the last digit in every row of a recording.

    It counts where these change, `DIFFERENT` rows or more have another number than most, and where other instruments
    are noisy; a simulation without noise is exact throughout. Thermometers are coarse, and some are given the air's by
    hand, so of those it is a warning. Angles, and two drives, have the rule above.
    """
    for recording in dict.fromkeys(sheet.run.recording for sheet in sheets):
        own = [sheet for sheet in sheets if sheet.run.recording == recording]
        told: set[str] = set()
        for first, copy in sorted(_alike_in_a_run(own), key=lambda pair: [_order(column) for column in pair]):
            both = [sheet for sheet in own if {first.name, copy.name} <= set(sheet.run.columns)]
            columns = [(sheet.run.columns[first.name], sheet.run.columns[copy.name]) for sheet in both]
            if copy.name in told or not all(np.array_equal(*pair) for pair in columns):
                continue
            _, count = np.unique(np.concatenate([values for values, _ in columns]), return_counts=True)
            if count.sum() - count.max() >= DIFFERENT and _is_any_noisy(both, {first.name, copy.name}):
                told.add(copy.name)
                tell = both[0].doubt if copy.channel.quantity in NOISY else both[0].warning
                remedy = "no two instruments agree to the last digit; look which of them was recorded"
                yield tell(copy.name, f"is a copy of {first.name} in every row of {counted(len(both), 'run')}", remedy)


def _alike_in_a_run(sheets: Sequence[Sheet]) -> set[tuple[Column, Column]]:
    """Return pairs of columns that are the same in a run in which they change; the second is an instrument's."""
    pairs = set()
    for sheet in sheets:
        alike: dict[tuple[float, ...], list[Column]] = defaultdict(list)
        for column, values in sheet.columns("load", *NOISY, *TEMPERATURES) if len(sheet.run) else ():
            low, high = sheet.run.extremes[column.name]
            if low < high:
                alike[low, high, float(values[0]), float(values[-1])].append(column)
        for group in alike.values():
            for first, copy in combinations(sorted(group, key=_order), 2):
                of_drives = {first.channel.quantity, copy.channel.quantity} <= set(EFFORT)  # one is made of the other
                values, others = (sheet.run.columns[column.name] for column in (first, copy))
                if copy.channel.role == "measured" and not of_drives and np.array_equal(values, others):
                    pairs.add((first, copy))
    return pairs


def _is_any_noisy(sheets: Sequence[Sheet], without: Set[str]) -> bool:
    """Return whether an instrument besides these columns reads a state at rest, or the rows of a motion, unevenly."""
    for sheet in sheets:
        labels = [values for name in STATE if (values := sheet.get(name)) is not None]
        if sheet.run.kind == "static" and labels:
            _, first, state = np.unique(np.stack(labels), axis=1, return_index=True, return_inverse=True)
        for column, values in sheet.columns(*NOISY):
            if column.name in without:
                continue
            if sheet.run.kind == "motion" and is_noisy(values):
                return True
            if sheet.run.kind == "static" and labels and np.any(values != values[first][state]):
                return True
    return False


def _order(column: Column) -> tuple[bool, bool, str]:
    """Of what is the same, loads were stated, and the air was there before."""
    return column.channel.role == "measured", column.channel.quantity != "ambient_temperature", column.name


def is_rich(values: Array) -> bool:
    """Return whether there are many different values; a few rows often tell."""
    return len(np.unique(values[:FEW])) >= DIFFERENT or len(np.unique(values)) >= DIFFERENT


def _commanded_alike(sheet: Sheet, first: int, second: int) -> bool:
    one, other = sheet.joint(first, "q_cmd"), sheet.joint(second, "q_cmd")
    return one is not None and other is not None and np.array_equal(one[1], other[1])
