"""What every part of the report hands over: numbers beside the published ones, sentences, and plain data."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from math import floor, isfinite, log10

from bench.report.paper.published import PublishedRow
from bench.report.tables import Column, Measured, Row, print_table

DIGITS = 4  # of the larger of our number and the paper's


@dataclass(frozen=True)
class ChapterTable:
    """A table of our numbers alone.

    Attributes:
        title: Stands above.
        columns, rows: As in `bench.report.tables`.
    """

    title: str
    columns: Sequence[Column]
    rows: Sequence[Row]


@dataclass(frozen=True)
class Chapter:
    """One experiment of the paper.

    Attributes:
        name: Key in the results, and name of its folder.
        title: What people read.
        rows: Our numbers beside the paper's.
        sentences: What follows, computed from the numbers.
        data: Everything, as plain data for JSON.
        tables: Further tables, which the paper has nothing beside.
    """

    name: str
    title: str
    rows: Sequence[PublishedRow]
    sentences: Sequence[str]
    data: Mapping[str, object]
    tables: Sequence[ChapterTable] = ()


def print_chapter(chapter: Chapter) -> None:
    """Print the comparison with the paper and what follows."""
    columns = [Column("ours"), Column("paper"), Column("difference")]
    rows = [_row(row) for row in chapter.rows]
    if rows:
        print_table(f"\n{chapter.title}", columns, rows, chapter.sentences)
    else:
        print(f"\n{chapter.title}")
        for sentence in chapter.sentences:
            print(sentence)
    for table in chapter.tables:
        print_table(f"\n{table.title}", table.columns, table.rows)


def _row(row: PublishedRow) -> Row:
    """Return a line whose numbers have the same decimals; the difference is that of the numbers as they are shown."""
    decimals = _decimals(row)
    ours, paper = round(row.ours, decimals), round(row.paper, decimals)
    name = f"{row.quantity} [{row.unit}]" if row.unit else row.quantity
    return Row(name, (Measured(ours), Measured(paper), Measured(ours - paper)), decimals)


def _decimals(row: PublishedRow) -> int:
    """Return decimals that leave the larger number `DIGITS` digits, and the paper's those that it is printed with."""
    sizes = [abs(value) for value in (row.ours, row.paper) if isfinite(value) and value != 0]
    printed = -int(Decimal(str(row.paper)).as_tuple().exponent) if isfinite(row.paper) else 0
    return max(DIGITS - 1 - floor(log10(max(sizes))) if sizes else 0, printed, 0)
