"""Parquet: flipped bits, files that unfold, types that are no numbers."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from bench.record.csv_table import read as read_csv
from bench.record.parquet_table import write
from tests.poison.variant import Spoil, Variant

NAME = "dwell"
FILE = f"runs/{NAME}.parquet"


def _as_parquet(change: Callable[[Path], None]) -> Spoil:
    """Store one table as the bench does, then spoil it."""

    def spoil(folder: Path) -> None:
        found = read_csv(folder / "runs" / f"{NAME}.csv", NAME, [])
        assert found
        write(folder / FILE, found[1])
        (folder / "runs" / f"{NAME}.csv").unlink()
        manifest = folder / "campaign.yaml"
        manifest.write_text(manifest.read_text().replace(f"name: {NAME}\n", f"name: {NAME}\n  file: {FILE}\n"))
        change(folder / FILE)

    return spoil


def _flip(share: float, bit: int) -> Callable[[Path], None]:
    def change(file: Path) -> None:
        data = bytearray(file.read_bytes())
        data[int(share * len(data))] ^= 1 << bit
        file.write_bytes(data)

    return change


def flipped_bits(rng: np.random.Generator) -> Iterator[Variant]:
    for _ in range(20):
        share, bit = float(rng.random()), int(rng.integers(8))
        spoil = _as_parquet(_flip(share, bit))
        yield Variant("flipped bits", f"bit {bit} at {share:.2%}", spoil, "error or harmless")


def cut_parquet(rng: np.random.Generator) -> Iterator[Variant]:
    changes: dict[str, Callable[[bytes], bytes]] = {
        "nothing": lambda data: b"",
        "four bytes": lambda data: b"PAR1",
        "half": lambda data: data[: len(data) // 2],
        "without its end": lambda data: data[:-9],
        "without its begin": lambda data: data[100:],
        "random bytes": lambda data: b"PAR1" + rng.bytes(4000) + b"PAR1",
        "zeros within": lambda data: data[:1000] + bytes(len(data) - 2000) + data[-1000:],
        "a footer of 4 GB": lambda data: data[:-8] + b"\xff\xff\xff\xff" + b"PAR1",
        "CSV": lambda data: b"time_s,pose\n1,2\n",
    }
    for name, change in changes.items():
        spoil = _as_parquet(lambda file, c=change: file.write_bytes(c(file.read_bytes())))
        yield Variant("cut Parquet", name, spoil, "error", (FILE, "no readable Parquet file"))


def parquet_that_unfolds(rng: np.random.Generator) -> Iterator[Variant]:
    def rows(file: Path) -> None:
        one = pa.DictionaryArray.from_arrays(pa.array(np.zeros(30_000_000, np.int8)), pa.array([1.0]))
        parquet.write_table(pa.table({"time_s": one}), file, row_group_size=30_000_000)

    def columns(file: Path) -> None:
        parquet.write_table(pa.table({f"c{i}": [1.0] for i in range(3000)}), file)

    yield Variant(
        "Parquet that unfolds", "30 million rows", _as_parquet(rows), "error", (FILE, "BENCH_MOST_TABLE_CELLS")
    )
    yield Variant(
        "Parquet that unfolds", "3000 columns", _as_parquet(columns), "error", (FILE, "BENCH_MOST_TABLE_COLUMNS")
    )


def parquet_of_other_types(rng: np.random.Generator) -> Iterator[Variant]:
    kinds: dict[str, pa.Array] = {
        "strings": pa.array(["1.5"]),
        "long strings": pa.array(["x" * 10_000_000]),
        "booleans": pa.array([True]),
        "lists": pa.array([[1.0, 2.0]]),
        "structures": pa.array([{"a": 1.0}]),
        "decimals": pa.array([1]).cast(pa.decimal128(30, 2)),
        "times": pa.array([1], pa.timestamp("ns")),
        "bytes": pa.array([b"\0"]),
    }
    for name, value in kinds.items():

        def change(file: Path, value: pa.Array = value) -> None:
            table = parquet.read_table(file).slice(0, 1)
            at = table.column_names.index("current_1_a")
            parquet.write_table(table.set_column(at, "current_1_a", value), file)

        yield Variant("Parquet of other types", name, _as_parquet(change), "error", (FILE, "current_1_a"))

    def empty(file: Path) -> None:
        table = parquet.read_table(file)
        column = pa.array([None] * len(table), pa.float64())
        parquet.write_table(table.set_column(table.column_names.index("current_1_a"), "current_1_a", column), file)

    yield Variant("Parquet of other types", "no values", _as_parquet(empty), "error", (FILE, "current_1_a", "row 1"))


FAMILIES = (flipped_bits, cut_parquet, parquet_that_unfolds, parquet_of_other_types)
