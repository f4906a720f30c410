"""Tables for the terminal: numbers with their standard errors, their decimal points below each other."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, isfinite, isinf, isnan, log10
from typing import TYPE_CHECKING

from bench.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table as RichTable

SIGNIFICANT = 2  # digits of the smallest standard error of a column, or of its smallest number where none has an error
MOST_DECIMALS = 9
UNKNOWN = "-"
WIDEST = 1000  # characters


@dataclass(frozen=True)
class Measured:
    """A number with its standard error.

    Attributes:
        value: In the unit of its column; nan prints as "-".
        error: Standard error in the same unit; None for a number that is known as it stands.
    """

    value: float
    error: float | None = None


@dataclass(frozen=True)
class Column:
    """One column of numbers.

    Attributes:
        name: Heading.
        unit: Stands below the heading, such as "1e6 Nm/rad".
        decimals: Digits behind the point; None takes as many as the numbers need.
    """

    name: str
    unit: str = ""
    decimals: int | None = None


@dataclass(frozen=True)
class Row:
    """One line.

    Attributes:
        name: Stands on the left.
        values: One per column.
        decimals: Digits behind the point of the values, which then have no errors; None takes those of the columns.
    """

    name: str
    values: tuple[Measured, ...]
    decimals: int | None = None


def print_table(
    title: str,
    columns: Sequence[Column],
    rows: Sequence[Row],
    notes: Sequence[str] = (),
    console: "Console | None" = None,
) -> None:
    """Print a table; without colour where the output is not a terminal, and in ASCII where it cannot show more.

    Args:
        title: Stands above.
        columns: The columns, without that of the names.
        rows: The lines.
        notes: Sentences below the table.
        console: Where to; None is standard output.

    Raises:
        InputError: A row has not as many values as there are columns.
    """
    console = console or terminal()
    sign = "\u00b1" if console.encoding.lower().startswith("utf") else "+-"
    print_wide(console, rich_table(title, columns, rows, sign))
    for note in notes:
        console.print(note, highlight=False, markup=False)


def terminal() -> "Console":
    """Return standard output for Rich; it raises `BrokenPipeError` where nobody reads on, as `print` does."""
    from rich.console import Console

    class Terminal(Console):
        def on_broken_pipe(self) -> None:  # called where the error is handled; Rich itself would exit with code 1
            raise  # noqa: PLE0704

    return Terminal()


def print_wide(console: "Console", table: "RichTable") -> None:
    """Print a table in which no number is cut, also where the output is narrower."""
    from rich.segment import Segments

    wide = console.options.update_width(WIDEST)
    console.print(Segments(console.render(table, wide)), crop=False, end="")


def rich_table(title: str, columns: Sequence[Column], rows: Sequence[Row], sign: str = "\u00b1") -> "RichTable":
    """Return the table for Rich; `sign` stands between value and error. Arguments and errors as in `print_table`."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    ragged = [row.name for row in rows if len(row.values) != len(columns)]
    if ragged:
        raise InputError(f"table {title!r}: {', '.join(ragged)}: needs {len(columns)} values, one per column.")
    table = Table(title=Text(title), title_justify="left", box=SIMPLE_HEAD, pad_edge=False, title_style="bold")
    table.add_column("")
    for column in columns:
        table.add_column(Text(f"{column.name}\n{column.unit}".rstrip(), justify="right"), justify="right", no_wrap=True)
    texts = [aligned([row.values[i] for row in rows], column.decimals, sign) for i, column in enumerate(columns)]
    for i, row in enumerate(rows):
        cells = [column[i] for column in texts]
        if row.decimals is not None:
            cells = [_text(measured.value, row.decimals) for measured in row.values]
        table.add_row(Text(row.name), *map(Text, cells))
    return table


def aligned(values: Sequence[Measured], decimals: int | None = None, sign: str = "\u00b1") -> list[str]:
    """Return the numbers of one column as text of one width, with as many decimals for all, points below each other."""
    digits = _decimals(values) if decimals is None else decimals
    errors = ["" if value.error is None or isnan(value.value) else _text(value.error, digits) for value in values]
    width = max(map(len, errors), default=0)
    blank = " " * (len(sign) + 2 + width) if width else ""
    return [
        _text(value.value, digits) + (f" {sign} {error:>{width}}" if error else blank)
        for value, error in zip(values, errors, strict=True)
    ]


def _decimals(values: Sequence[Measured]) -> int:
    errors = [value.error for value in values if value.error is not None]
    sizes = _countable(errors) or _countable([value.value for value in values])
    if not sizes:
        return 0
    return min(max(SIGNIFICANT - 1 - floor(log10(min(sizes))), 0), MOST_DECIMALS)


def _countable(numbers: Sequence[float]) -> list[float]:
    return [abs(number) for number in numbers if isfinite(number) and number != 0]


def _text(number: float, decimals: int) -> str:
    if isnan(number):
        return UNKNOWN
    return ("inf" if number > 0 else "-inf") if isinf(number) else f"{number:z.{decimals}f}"
