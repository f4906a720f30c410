"""`bench convert` says each kind of fault once, with the runs in which it stands."""

from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from tests.small_robot import write_small_robot

LOG = (
    "kind: motion\ncolumns:\n  time_s: {from: t}\n  q_cmd_1_rad: {from: q}\n  q_motor_1_rad: {from: m}\n"
    "  q_cmd_2_rad: {from: s}\n  current_1_a: {from: i}\n"
)
FILES, ROWS = 7, 200


def test_one_line_for_a_kind_of_fault(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot, logs, rng = write_small_robot(tmp_path / "robot"), tmp_path / "logs", np.random.default_rng(1)
    (robot / "log.yaml").write_text(LOG)
    logs.mkdir()
    for k in range(FILES):
        time = np.arange(ROWS) / 100
        angle, current = 0.3 * np.sin(2 * time + k), 2 * np.sin(2 * time) + rng.normal(0, 0.02, ROWS)
        time[40 + k :] += 1  # samples are lost
        table = np.column_stack([time, angle, np.full(ROWS, 0.1), 0 * time, current])  # and the encoder is frozen
        np.savetxt(logs / f"log{k}.csv", table, delimiter=",", header="t,q,m,s,i", comments="")
    assert main(["convert", str(robot), str(logs), "-o", str(tmp_path / "out")]) == 0
    frozen, lost, last = capsys.readouterr().out.splitlines()
    assert frozen.startswith("failed check  runs/log0.csv: q_motor_1_rad: is 0.1 in every row")
    assert lost.startswith("warning       runs/log0.csv: row 41 (line 42): time_s: is not 0.01 s after")
    for line in (frozen, lost):
        assert "(likewise in runs/log1.csv, runs/log2.csv, runs/log3.csv" in line
    assert last.endswith(f"{FILES} runs, {FILES * ROWS} rows, {FILES} failed plausibility checks, {FILES} warnings")


def test_a_folder_of_logs_is_looked_at_by_one_of_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["convert", "--look", str(tmp_path)]) == 2
    assert f"{tmp_path}: is a folder; give one of its logs" in capsys.readouterr().err
