"""How a log is written as text: separator, decimal sign, header, lines before it; stated in `log.yaml`, or guessed."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal, Self

from pydantic import Field, model_validator

from bench.record import csv_table, parquet_table
from bench.record.finding import Finding
from bench.record.limits import TABLE_BYTES
from bench.record.logs.dates import in_seconds
from bench.record.plain_file import FileFault, read_plain
from bench.record.strict import Strict
from bench.record.table import Table
from bench.record.units import FOREIGN

Separator = Literal[",", ";", "tab", "space", "|"]
SEPARATORS: dict[Separator, str] = {",": ",", ";": ";", "tab": "\t", "space": " ", "|": "|"}
LOOKED_AT = 20  # lines of numbers from which a guess is made (assumed: a fault in one of them does not hide the rest)
MOST_BEFORE = 200  # lines before the first numbers that a guess passes over (assumed: headers of instruments have 50)
UNITS = {*FOREIGN, *(foreign.si for foreign in FOREIGN.values()), "a", "n", "k", "", "-", "1", "deg/s", "rad/s", "m/s"}
_NUMBER = re.compile(r"[+-]?([0-9]+([.,][0-9]*)?|[.,][0-9]+)([eE][+-]?[0-9]+)?|[+-]?(nan|inf)", re.IGNORECASE)


class Dialect(Strict):
    """How the text of a log is written; of a Parquet file nothing of it matters."""

    separator: Separator = ","
    decimal: Literal[".", ","] = "."
    header: bool = Field(True, description="whether names stand above the numbers; else columns go by number, from 1")
    skip_lines: int = Field(0, ge=0, description="lines before the header, or before the numbers if there is none")
    units_line: bool = Field(False, description="whether a line with units stands between the header and the numbers")

    @model_validator(mode="after")
    def _is_readable(self) -> Self:
        if self.separator == self.decimal:
            raise ValueError("separator and decimal are both ','; which comma is which could not be told")
        if self.units_line and not self.header:
            raise ValueError("units_line stands below a header; without one count it among skip_lines")
        return self

    @property
    def lines_before(self) -> int:
        """Lines above the numbers."""
        return self.skip_lines + self.header + self.units_line

    def __str__(self) -> str:
        """As it is written into `log.yaml`."""
        stated = {
            name: value for name, value in self.model_dump().items() if value != type(self).model_fields[name].default
        }
        words = {"True": "true", "False": "false", ";": '";"', ",": '","', "|": '"|"'}
        return "{" + ", ".join(f"{name}: {words.get(str(value), value)}" for name, value in stated.items()) + "}"


PLAIN = Dialect.model_validate({})  # as a campaign's own tables are written


def read_log_table(file: Path, dialect: Dialect) -> Table:
    """Read the table of a log; whatever is wrong with it becomes a finding. Without a header, names are "1", "2"."""
    findings: list[Finding] = []
    try:
        if file.suffix.lower() == ".parquet":
            names, columns = parquet_table.read(file, file.name, findings, with_dates=True) or ((), {})
            return Table(names, columns, tuple(findings))
        data = in_seconds(read_plain(file, TABLE_BYTES))
    except FileFault as fault:
        return Table((), {}, (Finding("error", file.name, None, "", str(fault), fault.remedy),))
    if not data.strip():
        return Table((), {}, (Finding("error", file.name, None, "", "is empty", "give a log with rows in it"),))
    lines = max(data.count(b"\n"), data.count(b"\r")) + 1
    if dialect.skip_lines >= lines:
        message = f"has {lines} lines, and skip_lines passes over {dialect.skip_lines}"
        return Table((), {}, (Finding("error", file.name, None, "", message, "correct it in the log.yaml"),))
    guess = guess_dialect(data)
    if guess is not None and (other := _contradiction(dialect, guess, _lines(data))):
        remedy = f"write `table: {guess}` into the log.yaml; `bench convert --look` with this log proposes it"
        return Table((), {}, (Finding("error", file.name, None, "", other, remedy),))
    content = csv_table.parse(_as_csv(data, dialect), file.name, findings)
    before = dialect.lines_before
    names, columns = content or ((), {})
    return Table(names, columns, tuple(replace(finding, lines_before=before) for finding in findings))


def guess_dialect(data: bytes) -> Dialect | None:
    """Return how a text seems to be written: the separator that gives most columns of numbers; None if none does."""
    lines = _lines(data)
    best: tuple[tuple[int, int], Dialect] | None = None
    for name, separator in SEPARATORS.items():
        for decimal in (".", ","):
            if decimal == separator:
                continue
            first, count = _first_numbers(lines, separator, decimal)
            if count and (best is None or (count, decimal == ".") > best[0]):
                header, units = _above(lines[max(first - 2, 0) : first], separator, count)
                skipped = first - header - units
                dialect = Dialect(separator=name, decimal=decimal, header=header, skip_lines=skipped, units_line=units)
                best = (count, decimal == "."), dialect
    return best[1] if best else None


def cells_that_are_no_numbers(data: bytes) -> Iterator[tuple[str, int, str]]:
    """Yield of each column that keeps a log from being read its name, the first such row, from 1, and that cell.

    Nothing is said of a text whose separator cannot be told either: its lines have no equal number of cells, of which
    some are numbers.
    """
    lines = [line for line in _lines(data)[:MOST_BEFORE] if line.strip()]
    best: tuple[tuple[int, int], list[list[str]]] | None = None
    for separator in SEPARATORS.values():
        parted = [_cells(line, separator) for line in lines]
        counts = [len(cells) for cells in parted]
        count = max(set(counts), key=counts.count, default=0)
        table = [cells for cells in parted if len(cells) == count]
        is_even = 2 * len(table) > len(lines) and any(_is_any_number(cell) for cell in table[-1])
        if is_even and count > 1 and (best is None or (len(table), count) > best[0]):
            best = (len(table), count), table  # a separator parts the header, too
    if best is None:
        return
    header = not any(_is_any_number(cell) for cell in best[1][0])
    for place, (name, *cells) in enumerate(zip(*best[1], strict=True)):
        rows = cells if header else [name, *cells]
        if bad := next((row for row, cell in enumerate(rows, 1) if cell and not _is_any_number(cell)), None):
            yield name if header else str(place + 1), bad, rows[bad - 1]


def _is_any_number(cell: str) -> bool:
    return _NUMBER.fullmatch(cell) is not None


def _above(lines: Sequence[str], separator: str, count: int) -> tuple[bool, bool]:
    """Return whether a header stands in the last two lines above the numbers, and whether units stand below it."""
    cells = [_cells(line, separator) for line in lines]
    fits = [len(line) in (count, count + 1) for line in cells]  # the mark of a comment may be a cell of its own
    if len(fits) == 2 and all(fits) and all(cell.strip("[](){}#% ").lower() in UNITS for cell in cells[1]):
        return True, True
    return bool(fits and fits[-1]), False


def _first_numbers(lines: Sequence[str], separator: str, decimal: str) -> tuple[int, int]:
    """Return the first line with as many numbers as the lines after it, and how many; count 0 if there is none."""
    for first, line in enumerate(lines[:MOST_BEFORE]):
        count = _numbers(line, separator, decimal)
        if not count:
            continue
        after = [_numbers(other, separator, decimal) for other in lines[first : first + LOOKED_AT] if other.strip()]
        if sum(other == count for other in after) > len(after) / 2:
            return first, count
    return 0, 0


def _numbers(line: str, separator: str, decimal: str) -> int:
    """Return how many cells a line has if all of them are numbers or empty, else 0."""
    cells = _cells(line, separator)
    foreign = "," if decimal == "." else "."
    fits = [not cell or (_NUMBER.fullmatch(cell) is not None and foreign not in cell) for cell in cells]
    return len(cells) if all(fits) and any(cells) else 0


def _cells(line: str, separator: str) -> list[str]:
    if separator == " ":
        return line.split()
    cells = [cell.strip().strip('"') for cell in line.split(separator)]
    return cells[:-1] if cells and not cells[-1] else cells  # a separator at the end of a line ends the last cell


def _contradiction(stated: Dialect, guess: Dialect, lines: Sequence[str]) -> str:
    """Return what of a dialect as stated can hardly be, "" if it can."""
    places = (stated.skip_lines, stated.lines_before)
    header, first = (lines[place] if place < len(lines) else "" for place in places)
    separator = SEPARATORS[stated.separator]
    if _numbers(first, separator, stated.decimal):
        is_named = not stated.header or not _numbers(header, separator, stated.decimal)
        return "" if is_named else "has no header: its first line holds numbers"
    if stated.separator != guess.separator or stated.decimal != guess.decimal:
        commas = ", numbers have decimal commas" if guess.decimal == "," else ""
        words = {",": "commas", ";": "semicolons", "tab": "tabs", "space": "spaces", "|": "upright bars"}
        return f"cells are separated by {words[guess.separator]}{commas}"
    if guess.lines_before > stated.lines_before and not any(
        _NUMBER.fullmatch(cell) for cell in _cells(first, separator)
    ):
        return f"its numbers begin in line {guess.lines_before + 1}"
    return ""


def _lines(data: bytes) -> list[str]:
    """Return the first lines of a text."""
    text = in_seconds(data[: 1 << 20]).decode("utf-8-sig", errors="replace")
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def _as_csv(data: bytes, dialect: Dialect) -> bytes:
    """Return a text with commas, decimal points and a header."""
    if data.startswith(b"\xef\xbb\xbf"):
        data = data[3:]
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    for _ in range(dialect.skip_lines):
        data = data[data.find(b"\n") + 1 :] if b"\n" in data else b""
    if dialect.header:
        data = data.lstrip(b"#% \t")  # a header that is marked as a comment
    if dialect.units_line:
        end = data.find(b"\n") + 1
        data = data[:end] + data[data.find(b"\n", end) + 1 :]
    if dialect.decimal == ",":
        data = data.replace(b",", b".")
    separator = SEPARATORS[dialect.separator].encode()
    if dialect.separator == "space":
        data = re.sub(rb"[ \t]+", b",", re.sub(rb"[ \t]*\n[ \t]*", b"\n", data.strip(b" \t")))
    elif separator != b",":
        data = data.replace(separator, b",")
    begin = data.find(b"\n") + 1 if dialect.header else 0
    ended = re.compile(rb",[ \t]*(?=\n|$)")
    lines = data.count(b"\n", begin) + (not data.endswith(b"\n"))
    if lines and len(ended.findall(data, begin)) >= lines:  # every row ends with a separator
        data = re.sub(rb",[ \t]*$", b"", data[:begin], flags=re.MULTILINE) + ended.sub(b"", data[begin:])
    if dialect.header:
        return data
    end = data.find(b"\n")
    count = data.count(b",", 0, end if end >= 0 else len(data)) + 1
    return ",".join(str(number) for number in range(1, count + 1)).encode() + b"\n" + data
