"""What every part of the report hands over: numbers beside the published ones, sentences, and plain data."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bench.report.paper.published import PublishedRow
from bench.report.tables import Column, Measured, Row, print_table


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
    rows = [
        Row(
            f"{row.quantity} [{row.unit}]" if row.unit else row.quantity,
            tuple(Measured(_rounded(value)) for value in (row.ours, row.paper, row.difference)),
        )
        for row in chapter.rows
    ]
    if rows:
        print_table(f"\n{chapter.title}", columns, rows, chapter.sentences)
    else:
        print(f"\n{chapter.title}")
        for sentence in chapter.sentences:
            print(sentence)
    for table in chapter.tables:
        print_table(f"\n{table.title}", table.columns, table.rows)


def _rounded(value: float) -> float:
    return float(f"{value:.4g}")
