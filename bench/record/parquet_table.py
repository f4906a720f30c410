"""Parquet: one numeric column for each channel. PyArrow is loaded when the first such file turns up.

What a file says of its size is looked at before anything is decoded: a kilobyte may unfold into gigabytes. Each page
that the bench writes has a checksum, and checksums are held against the pages that are read.
"""

from base64 import b64decode
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.limits import TABLE_BYTES, TABLE_CELLS, TABLE_COLUMNS
from bench.record.plain_file import read_plain


def read(
    path: Path, file: str, findings: list[Finding], with_dates: bool = False
) -> tuple[tuple[str, ...], dict[str, Array]] | None:
    """Read a Parquet file; see `bench.record.table.Format`. In a log (`with_dates`) a date is seconds since 1970."""
    import pyarrow as pa
    from pyarrow import parquet

    def fault(message: str, remedy: str, column: str = "") -> None:
        findings.append(Finding("error", file, None, column, message, remedy))

    data = read_plain(path, TABLE_BYTES)
    try:
        stored = parquet.ParquetFile(pa.BufferReader(data), page_checksum_verification=True, pre_buffer=False)
        if too_much := _too_much(stored.metadata):
            fault(*too_much)
            return None
        schema = stored.schema_arrow
        if _names_again(stored.metadata) not in (None, schema.names):
            fault("is damaged: its two lists of column names differ", "write it again")
            return None
        dates = [with_dates and pa.types.is_timestamp(t) for t in schema.types]
        numeric = [pa.types.is_integer(t) or pa.types.is_floating(t) or pa.types.is_null(t) for t in schema.types]
        numeric = [is_number or is_date for is_number, is_date in zip(numeric, dates, strict=True)]
        wanted = [name for name in dict.fromkeys(schema.names) if numeric[schema.names.index(name)]]
        table = stored.read(columns=wanted, use_threads=False)
    except (pa.ArrowException, OSError, ValueError) as error:
        fault(f"is no readable Parquet file ({' '.join(str(error).split())[:200]})", "write it again")
        return None
    columns: dict[str, Array] = {}
    for name, kind, is_number in zip(schema.names, schema.types, numeric, strict=True):
        if not is_number:
            fault(f"holds {str(kind)[:60]}, not numbers", "store it as float64", name)
    for name, column in zip(table.column_names, table.columns, strict=True):
        if name in columns:
            continue
        if pa.types.is_null(column.type):
            columns[name] = np.full(len(column), np.nan)
        elif pa.types.is_timestamp(column.type):
            nanoseconds = column.cast(pa.timestamp("ns"), safe=False).cast(pa.int64()).cast(pa.float64(), safe=False)
            columns[name] = np.asarray(nanoseconds.to_numpy(), dtype=np.float64) * 1e-9
        else:
            numbers = column if pa.types.is_float64(column.type) else column.cast(pa.float64(), safe=False)
            columns[name] = np.asarray(numbers.to_numpy(), dtype=np.float64)
        columns[name].flags.writeable = False  # a run need not copy it
    return tuple(schema.names), columns


def _too_much(metadata: Any) -> tuple[str, str] | None:
    """Return what is too large about a file, and what to do."""
    rows = max(metadata.num_rows, sum(metadata.row_group(i).num_rows for i in range(metadata.num_row_groups)))
    for limit, found in ((TABLE_COLUMNS, metadata.num_columns), (TABLE_CELLS, rows * metadata.num_columns)):
        if limit.exceeded(found):
            return f"has more than {limit}", limit.remedy
    return None


def _names_again(metadata: Any) -> list[str] | None:
    """Return the names of the columns as Arrow has them beside those of Parquet, which no checksum covers."""
    import pyarrow as pa

    text = (metadata.metadata or {}).get(b"ARROW:schema")
    return None if text is None else pa.ipc.read_schema(pa.BufferReader(b64decode(text))).names


def write(path: Path, columns: Mapping[str, Array]) -> None:
    """Write columns as float64."""
    import pyarrow as pa
    from pyarrow import parquet

    parquet.write_table(pa.table(dict(columns)), path, write_page_checksum=True)
