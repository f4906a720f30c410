"""CSV: commas, decimal points, UTF-8, names in the first line. Numbers come back bit for bit.

A table of plain finite numbers is read by PyArrow. Any other goes cell by cell through Python, which knows what each
cell may be and where it stands; both read a number alike, to the last bit.
"""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from bench.errors import MOST_OF_NAME
from bench.record.campaign import Array
from bench.record.finding import Finding, spell_rows
from bench.record.limits import TABLE_BYTES, TABLE_CELLS, TABLE_COLUMNS
from bench.record.plain_file import read_plain

_NUMBER = re.compile(r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?|[+-]?(nan|inf|infinity)", re.IGNORECASE)
OTHER_FILES: Mapping[bytes, tuple[str, str]] = {  # by how they begin: what they are, and what to do
    b"PK\x03\x04": ("is a workbook (.xlsx, .ods) or another zip archive", "save its sheet as CSV, or unpack it"),
    b"\xd0\xcf\x11\xe0": ("is a workbook of old (.xls)", "save its sheet as CSV"),
    b"\x1f\x8b": ("is compressed by gzip", "unpack it: gunzip"),
    b"(\xb5\x2f\xfd": ("is compressed by zstd", "unpack it: zstd -d"),
    b"PAR1": ("is Parquet", "name it .parquet"),
    b"\x89HDF": ("is HDF5", "write its tables as CSV or Parquet"),
    b"%PDF": ("is a PDF", "save the table as CSV"),
    b"version https://git-lfs": ("is a pointer of Git LFS, not the table", "fetch the table: git lfs pull"),
}
LONGEST_CELL = 1100  # characters; the longest double takes 1077 digits when written out, and 17 are enough
_COMMA_NUMBER = re.compile(r"[+-]?[0-9]*,[0-9]+([eE][+-]?[0-9]+)?")
_GROUPED = re.compile(r"[+-]?[0-9]{1,3}([.,' \u00a0\u2009\u202f][0-9]{3})+([.,][0-9]*)?")  # thousands apart
_CLOCK = re.compile(r"([0-9]{1,4}[./-][0-9]{1,2}[./-][0-9]{1,4}[T ]*)?([0-9]{1,2}:[0-9]{2}(:[0-9.,]+)?.*)?")


def read(path: Path, file: str, findings: list[Finding]) -> tuple[tuple[str, ...], dict[str, Array]] | None:
    """Read a CSV file; see `bench.record.table.Format`."""
    return parse(read_plain(path, TABLE_BYTES), file, findings)


def parse(data: bytes, file: str, findings: list[Finding]) -> tuple[tuple[str, ...], dict[str, Array]] | None:
    """Take the contents of a CSV file apart; see `bench.record.table.Format`."""
    if other := next((words for begin, words in OTHER_FILES.items() if data.startswith(begin)), None):
        findings.append(Finding("error", file, None, "", *other))
        return None
    if too_much := _too_much(data):
        findings.append(Finding("error", file, None, "", *too_much))
        return None
    return plain_numbers(data) or cell_by_cell(data, file, findings)


def _too_much(data: bytes) -> tuple[str, str] | None:
    """Return what is too large about a table, and what to do; its cells are counted before any is read."""
    end = min((place for place in (data.find(b"\n"), data.find(b"\r")) if place >= 0), default=len(data))
    names = data.count(b",", 0, end) + 1
    lines = max(data.count(b"\n"), data.count(b"\r")) + 1
    for limit, found in ((TABLE_COLUMNS, names), (TABLE_CELLS, max(names * lines, data.count(b",")))):
        if limit.exceeded(found):
            return f"has more than {limit}", limit.remedy
    return None


def cell_by_cell(data: bytes, file: str, findings: list[Finding]) -> tuple[tuple[str, ...], dict[str, Array]] | None:
    """Read a CSV file, whatever stands in it, and name what is wrong with it; see `bench.record.table.Format`."""

    def fault(message: str, remedy: str, row: int | None = None, column: str = "") -> None:
        findings.append(Finding("error", file, row, column, message, remedy))

    text = _text(data)
    if text is None or text[:MOST_OF_NAME].count("\0") > len(text[:MOST_OF_NAME]) / 3:
        fault("holds zero bytes: UTF-16 text, or damaged" if text else "is not UTF-8 text", "save it as UTF-8")
        return None
    header, *lines = text.split("\n")
    while lines and not lines[-1].strip():
        lines.pop()
    if other := _another_separator(header, lines):
        fault(other, "save it with commas and decimal points")
        return None
    names = tuple(_cells(header)) if header or lines else ()
    rows = [_cells(line) for line in lines]
    wrong = [number for number, cells in enumerate(rows, 1) if len(cells) != len(names)]
    if wrong:
        message, remedy = _wrong_length(names, rows, wrong)
        fault(message, remedy, wrong[0])
        return None
    if worded := [number for number, cells in enumerate(rows, 1) if _has_words_alone(cells)]:
        is_header = tuple(rows[worded[0] - 1]) == names
        what = "the header again" if is_header else "no number at all; a line of units?"
        fault(f"holds {what}, {spell_rows(worded)}", "remove it: every row is a reading", worded[0])
        return None
    columns: dict[str, Array] = {}
    for name, cells in zip(names, zip(*rows, strict=True) if rows else ((),) * len(names), strict=True):
        bad = [number for number, cell in enumerate(cells, 1) if cell and not is_number(cell)]
        if bad:
            cell = cells[bad[0] - 1]
            fault(f"{cell[:40]!r} is no number, {spell_rows(bad)}", in_place_of(cell), bad[0], name)
        elif name not in columns:
            columns[name] = np.array([float(cell or "nan") for cell in cells])
    return names, columns


def in_place_of(cell: str) -> str:
    """Return what to write in place of a cell that is no number."""
    cell = cell[:LONGEST_CELL]
    if _COMMA_NUMBER.fullmatch(cell):
        return "write a decimal point"
    if _GROUPED.fullmatch(cell):
        return "write numbers without marks between thousands"
    if cell and _CLOCK.fullmatch(cell):
        return "write seconds; in logs moments like 2024-05-13T09:00:00.002 are read too"
    return "write a number; remarks belong into the note of the run"


def write(path: Path, columns: Mapping[str, Array]) -> None:
    """Write columns; whole numbers without a decimal point, all others with as many digits as they need."""
    cells = [[_number(value) for value in values.tolist()] for values in columns.values()]
    lines = [",".join(columns), *(",".join(row) for row in zip(*cells, strict=True))]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


def _another_separator(header: str, lines: Sequence[str]) -> str:
    """Return what separates the cells of a table in place of commas, "" if commas do."""
    if "," in header:
        return ""
    for separator, word in ((";", "semicolons"), ("\t", "tabs"), ("|", "upright bars"), (" ", "spaces")):
        if separator in header.strip() and any(separator in line.strip() for line in lines):
            decimals = " and numbers have decimal commas" if any("," in line for line in lines) else ""
            return f"cells are separated by {word}{decimals}"
    return ""


def _wrong_length(names: Sequence[str], rows: Sequence[Sequence[str]], wrong: Sequence[int]) -> tuple[str, str]:
    """Return message and remedy for rows that have more or fewer cells than there are names."""
    first = rows[wrong[0] - 1]
    message = f"{len(first)} cells under {len(names)} names in {spell_rows(wrong)}"
    if len(wrong) < len(rows) or len(first) < len(names):
        return message, "give every row one cell for each name"
    if len(names) == 1 or _has_words_alone(rows[0]):
        message = f"its first line, {','.join(names)[:40]!r}, holds no names for {len(first)} columns"
        return message, "put the names into the first line, and remarks into the note of the run"
    if any("." in cell for cells in rows for cell in cells):
        return message, "name every column in the first line"
    return message, "write numbers with decimal points, not commas"


def _has_words_alone(cells: Sequence[str]) -> bool:
    """Whether a row of several cells holds words or nothing where readings stand."""
    return len(cells) > 1 and any(cells) and not any(is_number(cell) for cell in cells)


def is_number(cell: str) -> bool:
    """Whether a cell is written as a number, also as nan or inf."""
    return len(cell) <= LONGEST_CELL and _NUMBER.fullmatch(cell) is not None


def _number(value: float) -> str:
    text = repr(value)
    return text[:-2] if text.endswith(".0") else text


def plain_numbers(data: bytes) -> tuple[tuple[str, ...], dict[str, Array]] | None:
    """Return names and columns of a table with nothing but finite numbers under its header; None for any other."""
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    first, last = data.find(b"\n") + 1, len(data)
    while last > first and data[last - 1 : last].isspace():
        last -= 1
    header = _text(data[: max(first - 1, 0)])
    if not header or first == last:
        return None
    names = tuple(_cells(header))
    import pyarrow as pa  # here, so that what reads no table need not load it
    from pyarrow import csv

    keys = [str(place) for place in range(len(names))]  # names may repeat
    try:
        table = csv.read_csv(
            pa.py_buffer(memoryview(data)[first:last]),  # no copy: a log may be large
            csv.ReadOptions(use_threads=False, column_names=keys),
            csv.ParseOptions(quote_char=False, ignore_empty_lines=False),
            csv.ConvertOptions(column_types=dict.fromkeys(keys, pa.float64()), null_values=[]),
        )
    except pa.ArrowException:
        return None
    columns: dict[str, Array] = {}
    for name, values in zip(names, table.columns, strict=True):
        columns.setdefault(name, values.to_numpy()).flags.writeable = False  # a run need not copy it
    return (names, columns) if all(np.isfinite(values).all() for values in columns.values()) else None


def _text(data: bytes) -> str | None:
    """Decode, with any line ends and with or without a byte order mark."""
    try:
        return data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError:
        return None


def _cells(line: str) -> Sequence[str]:
    """Split a line; spreadsheets may put quotes around a cell, and a quoted cell may hold a comma."""
    if '"' not in line:
        return [cell.strip() for cell in line.split(",")]
    return [cell.strip().strip('"').strip() for cell in re.findall(r'(?:^|,)((?:"[^"]*"|[^,])*)', line)]
