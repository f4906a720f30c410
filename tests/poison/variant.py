"""One way to spoil something, and the answer that is right."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

Answer = Literal["error", "doubt", "harmless", "error or harmless"]
Spoil = Callable[[Path], None]


@dataclass(frozen=True)
class Variant:
    """One variant.

    Attributes:
        family: What kind of fault it is.
        name: Which one.
        spoil: Spoils a folder that holds a campaign with its robot in `robot`.
        answer: What is right: an error, a doubt, or no fault at all. What flips a bit anywhere may do no harm.
        places: Words of which each has to stand in what is printed: file, row, column, key.
        command: To run in the folder.
    """

    family: str
    name: str
    spoil: Spoil
    answer: Answer
    places: tuple[str, ...] = ()
    command: tuple[str, ...] = ("check", ".")


Family = Callable[[np.random.Generator], Iterator[Variant]]


def tables(folder: Path) -> list[Path]:
    """Return the tables of a campaign, in order."""
    return sorted(folder.glob("runs/*.csv"))


class Sheet:
    """A table as text, to spoil."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.names, *self.rows = (line.split(",") for line in file.read_text().splitlines())

    def set(self, row: int, column: str, cell: str) -> None:
        """Set a cell; rows count from 1."""
        self.rows[row - 1][self.names.index(column)] = cell

    def change(self, column: str, change: Callable[[np.ndarray], np.ndarray]) -> None:
        """Change the numbers of a column."""
        place = self.names.index(column)
        for row, value in zip(self.rows, change(np.array([float(row[place]) for row in self.rows])), strict=True):
            row[place] = repr(float(value))

    def write(self) -> None:
        self.file.write_text("\n".join(",".join(row) for row in [self.names, *self.rows]) + "\n")


def in_tables(change: Callable[[Sheet], object], name: str = "*.csv") -> Spoil:
    """Return what changes every table, or one."""

    def spoil(folder: Path) -> None:
        for file in sorted(folder.glob(f"runs/{name}")):
            sheet = Sheet(file)
            change(sheet)
            sheet.write()

    return spoil


def in_column(change: Callable[[np.ndarray], np.ndarray], *columns: str) -> Spoil:
    """Return what changes columns in every table that has them."""

    def changed(sheet: Sheet) -> None:
        for column in columns:
            if column in sheet.names:
                sheet.change(column, change)

    return in_tables(changed)


def exchanged(first: str, second: str) -> Spoil:
    """Return what exchanges two columns in every table."""

    def spoil(folder: Path) -> None:
        for file in tables(folder):
            text = file.read_text().replace(first, "@").replace(second, first)
            file.write_text(text.replace("@", second))

    return spoil


def of(family: str, *variants: Variant) -> Iterator[Variant]:
    """Yield variants as of one family."""
    yield from (replace(variant, family=family) for variant in variants)
