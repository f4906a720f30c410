"""Parquet: one numeric column for each channel. PyArrow is loaded when the first such file turns up."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from bench.record.campaign import Array
from bench.record.finding import Finding


def read(path: Path, file: str, findings: list[Finding]) -> tuple[tuple[str, ...], dict[str, Array]] | None:
    """Read a Parquet file; see `bench.record.table.Format`."""
    import pyarrow as pa
    from pyarrow import parquet

    def fault(message: str, remedy: str, column: str = "") -> None:
        findings.append(Finding("error", file, None, column, message, remedy))

    data = path.read_bytes()
    try:
        stored = parquet.ParquetFile(pa.BufferReader(data), page_checksum_verification=True, pre_buffer=False)
        table = stored.read(use_threads=False)
    except (pa.ArrowException, OSError, ValueError) as error:
        fault(f"is no readable Parquet file ({' '.join(str(error).split())[:200]})", "write it again")
        return None
    columns: dict[str, Array] = {}
    for name, column in zip(table.column_names, table.columns, strict=True):
        kind = column.type
        if not (pa.types.is_integer(kind) or pa.types.is_floating(kind) or pa.types.is_null(kind)):
            fault(f"holds {kind}, not numbers", "store it as float64", name)
        elif name not in columns:
            numbers = column if pa.types.is_float64(kind) else column.cast(pa.float64(), safe=False)
            columns[name] = np.asarray(numbers.to_numpy(), dtype=np.float64)
            columns[name].flags.writeable = False  # a run need not copy it
    return tuple(table.column_names), columns


def write(path: Path, columns: Mapping[str, Array]) -> None:
    """Write columns as float64."""
    import pyarrow as pa
    from pyarrow import parquet

    parquet.write_table(pa.table(dict(columns)), path, write_page_checksum=True)
