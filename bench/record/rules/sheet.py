"""One run as the rules see it."""

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bench.record.campaign import Arm, Array, Run
from bench.record.channels import Column, columns_of, parse_column
from bench.record.finding import Finding, Level, spell_rows

# Movement that no noise, backlash or deflection of an arm makes: half a degree, 2 mm on a slide.
TRAVEL = {"rad": 0.01, "m": 0.002}
LOAD_N = 10.0  # [N] change of a load that a force sensor cannot miss


@dataclass(frozen=True)
class Sheet:
    """A run with the name of its file, the columns as they are named there, and the robot if it is known.

    Attributes:
        run: The readings; columns that an earlier rule found unusable are left out.
        file: Path of the table relative to the campaign folder.
        names: All column names in the order of the file, with repetitions.
        arm: The robot, or None.
        factors: Column -> what its values were multiplied by when they were made of a log.
    """

    run: Run
    file: str
    names: tuple[str, ...]
    arm: Arm | None = None
    factors: Mapping[str, float] = field(default_factory=dict)

    def without(self, names: Set[str]) -> "Sheet":
        """Return the sheet with fewer columns to look at."""
        if not names & set(self.run.columns):
            return self
        kept = {name: values for name, values in self.run.columns.items() if name not in names}
        return replace(self, run=replace(self.run, columns=kept))

    def error(self, column: str, message: str, remedy: str, rows: Sequence[int] = ()) -> Finding:
        """Make a finding that keeps the campaign from being used; `rows`, counted from 1, are added to the message."""
        return self._finding("error", column, message, remedy, rows)

    def doubt(self, column: str, message: str, remedy: str, rows: Sequence[int] = ()) -> Finding:
        """Make a finding that a channel is hardly what its name says; `rows`, from 1, are added to the message."""
        return self._finding("doubt", column, message, remedy, rows)

    def warning(self, column: str, message: str, remedy: str, rows: Sequence[int] = ()) -> Finding:
        """Make a finding that somebody should look at; `rows`, counted from 1, are added to the message."""
        return self._finding("warning", column, message, remedy, rows)

    def get(self, name: str) -> Array | None:
        """Return a column, shape (n_rows,), or None."""
        return self.run.columns.get(name)

    def columns(self, *quantities: str) -> Iterator[tuple[Column, Array]]:
        """Yield the columns that hold one of the quantities."""
        for column in columns_of(self.run.columns, *quantities):
            yield column, self.run.columns[column.name]

    def joint(self, index: int, *quantities: str) -> tuple[Column, Array] | None:
        """Return the first of these joint coordinates ("q_motor", "q_cmd", "q_link") that joint `index` has."""
        for quantity in quantities:
            for column, values in self.columns(quantity):
                if column.index == index:
                    return column, values
        return None

    def moves(self, name: str) -> bool:
        """Whether a joint coordinate moves by more than `TRAVEL`."""
        column, (low, high) = parse_column(name), self.run.extremes[name]
        return column is not None and column.unit in TRAVEL and high - low > TRAVEL[column.unit]

    def within(self, name: str, lower: float, upper: float) -> bool:
        """Whether all values of a column lie from `lower` to `upper`; none does that is nan."""
        low, high = self.run.extremes.get(name, (lower, upper))
        return lower <= low and high <= upper

    def rows_outside(self, name: str, lower: float, upper: float) -> list[int]:
        """Return the rows, counted from 1, in which a column lies below `lower` or above `upper`; nan does neither."""
        if self.within(name, lower, upper):
            return []
        values = self.run.columns[name]
        return rows_where((values < lower) | (values > upper))

    def _finding(self, level: Level, column: str, message: str, remedy: str, rows: Sequence[int]) -> Finding:
        if not rows:
            return Finding(level, self.file, None, column, message, remedy)
        return Finding(level, self.file, rows[0], column, f"{message}, {spell_rows(rows)}", remedy)


def rows_where(mask: NDArray[np.bool_]) -> list[int]:
    """Return the rows, counted from 1, where `mask` is true."""
    return (np.flatnonzero(mask) + 1).tolist() if mask.any() else []
