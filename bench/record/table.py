"""A table on its way between a file and a run: names, columns, and what was wrong with the file itself.

A file format is one entry of `FORMATS`: a function that reads and one that writes.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from bench.record import csv_table, parquet_table
from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.plain_file import FileFault


class Format(NamedTuple):
    """How tables of one kind are read and written.

    Attributes:
        read: (path, name of the file in findings, findings to add to) -> column names and columns; None if the file
            cannot be taken apart. Columns with faulty cells are left out; a missing value is nan. A file that is not
            plain or too large raises `FileFault`.
        write: (path, columns) -> None.
    """

    read: Callable[[Path, str, list[Finding]], tuple[tuple[str, ...], dict[str, Array]] | None]
    write: Callable[[Path, Mapping[str, Array]], None]


FORMATS: Mapping[str, Format] = {
    ".csv": Format(csv_table.read, csv_table.write),
    ".parquet": Format(parquet_table.read, parquet_table.write),
}


SET_ASIDE = "_"  # a column whose name begins with this is not read


@dataclass(frozen=True)
class Table:
    """What could be read of one file.

    Attributes:
        names: Column names in the order of the file, with repetitions.
        columns: Name -> shape (n_rows,); those without faulty cells.
        findings: What is wrong with the file.
    """

    names: tuple[str, ...]
    columns: Mapping[str, Array]
    findings: tuple[Finding, ...]


def read_table(folder: Path, file: str) -> Table:
    """Read one table; whatever is wrong with it becomes a finding."""
    findings: list[Finding] = []
    try:
        content = FORMATS[Path(file).suffix.lower()].read(folder / file, file, findings)
    except FileFault as fault:
        findings.append(Finding("error", file, None, "", str(fault), fault.remedy))
        content = None
    names, columns = content or ((), {})
    findings = [finding for finding in findings if not finding.column.startswith(SET_ASIDE)]
    if names and all(csv_table.is_number(name) for name in names):
        message, remedy = "has no header: its first line holds numbers", "write the names of the columns above them"
        return Table((), {}, (Finding("error", file, None, "", message, remedy),))
    if not names and not findings:
        findings.append(
            Finding("error", file, None, "", "is empty", "write the column names, and a row for each reading")
        )
    return Table(names, columns, tuple(findings))
