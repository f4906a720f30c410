"""Parquet as other programs write it."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from bench.record.check import check_campaign
from bench.record.finding import Finding
from bench.record.parquet_table import read, write
from tests.record.build import only

MANIFEST = "format: 1\nrobot: small\nruns: [{name: a, kind: static, start_s: 0, file: a.parquet}]\n"


def folder_with(tmp_path: Path, **columns: pa.Array) -> Path:
    labels = {name: pa.array([1, 1], pa.int8()) for name in ("pose", "approach", "repeat")}
    steps = {"load_step": pa.array([0, 0], pa.int8()), "repeat": pa.array([1, 2], pa.int16())}
    table = labels | steps | {"q_cmd_1_rad": pa.array([0.5, 0.5], pa.float32())} | columns
    parquet.write_table(pa.table(table), tmp_path / "a.parquet")
    (tmp_path / "campaign.yaml").write_text(MANIFEST)
    return tmp_path


def test_integers_and_single_precision_are_accepted(tmp_path: Path) -> None:
    report = check_campaign(folder_with(tmp_path, current_1_a=pa.array([1.5, 2.5], pa.float32())))
    assert report.findings == ()
    columns = report.usable().runs[0].columns
    assert {values.dtype for values in columns.values()} == {np.dtype(np.float64)}
    np.testing.assert_array_equal(columns["current_1_a"], [1.5, 2.5])


@pytest.mark.parametrize(
    ("values", "row", "words"),
    [
        (pa.array([1.5, None]), 2, "no value"),
        (pa.array([None, None]), 1, "no value"),
        (pa.array(["1.5", "2.5"]), None, "holds string, not numbers"),
        (pa.array([True, False]), None, "holds bool, not numbers"),
    ],
)
def test_what_is_no_number_is_named(values: pa.Array, row: int | None, words: str, tmp_path: Path) -> None:
    folder = folder_with(tmp_path, current_1_a=values)
    finding = only(list(check_campaign(folder).findings))
    assert (finding.row, finding.column, finding.line) == (row, "current_1_a", None)
    assert words in finding.message


def test_damaged_file_is_named(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, current_1_a=pa.array([1.5, 2.5]))
    (folder / "a.parquet").write_bytes((folder / "a.parquet").read_bytes()[:-20])
    finding = only(list(check_campaign(folder).findings))
    assert finding.file == "a.parquet"
    assert "no readable Parquet file" in finding.message


def test_no_flipped_bit_is_believed(tmp_path: Path, rng: np.random.Generator) -> None:
    """Pages have checksums, names stand there twice, and what else is damaged cannot be read."""
    columns = {name: rng.normal(size=20) for name in ("q_cmd_1_rad", "q_motor_1_rad", "current_1_a")}
    file = tmp_path / "a.parquet"
    write(file, columns)
    data = file.read_bytes()
    refused = 0
    for at in range(0, len(data), 3):
        damaged = bytearray(data)
        damaged[at] ^= 1 << int(rng.integers(8))
        file.write_bytes(damaged)
        findings: list[Finding] = []
        found = read(file, "a.parquet", findings)
        if findings:
            refused += 1
            assert len(findings) == 1
            continue
        assert found is not None
        assert found[0] == tuple(columns)
        for name, values in columns.items():
            np.testing.assert_array_equal(found[1][name], values)
    assert refused > len(data) / 6  # the rest are statistics and what else no reader needs


def test_what_unfolds_is_not_decoded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = folder_with(tmp_path, current_1_a=pa.array([1.5, 2.5]))
    monkeypatch.setenv("BENCH_MOST_TABLE_CELLS", "11")  # it has 2 rows of 6 columns
    finding = only(list(check_campaign(folder).findings))
    assert (finding.file, finding.message) == ("a.parquet", "has more than 11 cells")
    assert "BENCH_MOST_TABLE_CELLS" in finding.remedy


def test_csv_needs_no_pyarrow() -> None:
    probe = (
        "import sys; sys.modules['pyarrow'] = None; import bench.record.read, bench.record.write, bench.record.truth"
    )
    subprocess.run([sys.executable, "-c", probe], check=True)
