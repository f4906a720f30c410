"""One fault in many runs and columns is one line; few faults, and figures of channels, are shown one by one."""

from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from bench.cli.check import SCREEN
from bench.errors import CampaignError
from bench.record.campaign import Campaign
from bench.record.check import check_campaign
from bench.record.csv_table import write as write_csv
from bench.record.finding import Finding
from bench.record.limits import Limit
from bench.record.logs.likewise import FEW, at_a_glance
from bench.record.manifest import manifest_text
from bench.record.plain_file import FileFault, expect_plain
from tests.record.build import motion, sweep

RUNS = 12


def folder_in_degrees(folder: Path) -> Path:
    """Write a campaign whose angles are all in degrees, a hundred times over."""
    (folder / "runs").mkdir(parents=True)
    runs = []
    for i in range(RUNS):
        columns = {name: 100 * v if name.startswith("q_") else v for name, v in sweep(i).items()}
        runs.append(motion(columns, f"run{i}", 100.0 * i))
        write_csv(folder / "runs" / f"run{i}.csv", columns)
    (folder / "campaign.yaml").write_text(manifest_text(Campaign("hh150", tuple(runs)), ".csv"))
    return folder


def test_a_fault_of_many_runs_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = folder_in_degrees(tmp_path / "campaign")
    report = check_campaign(folder)
    assert len(report.errors) > RUNS
    assert main(["check", str(folder)]) == CampaignError.exit_code
    (line, *_, last) = capsys.readouterr().out.splitlines()
    assert "no position of this joint" in line
    assert "likewise in" in line
    assert "more" in line
    assert f"{len(report.errors)} errors" in last
    with pytest.raises(CampaignError) as caught:
        report.usable()
    assert len(caught.value.problems) < RUNS


def test_many_kinds_of_faults_are_a_screen(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "campaign"
    (folder / "runs").mkdir(parents=True)
    columns = sweep() | {f"a{'bcdefghijklmnopqrstuvwxyz'[i % 25]}{'x' * i}": np.zeros(2500) for i in range(2 * SCREEN)}
    write_csv(folder / "runs" / "a.csv", columns)
    (folder / "campaign.yaml").write_text(manifest_text(Campaign("hh150", (motion(columns),)), ".csv"))
    main(["check", str(folder)])
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == SCREEN + 2
    assert "more kinds of findings" in lines[-2]


def test_few_findings_and_those_of_all_runs_keep_their_figures() -> None:
    few = [Finding("error", f"runs/{i}.csv", 1, "pose", f"{i}.5 is no label", "write 0, 1, 2") for i in range(FEW)]
    assert at_a_glance(few) == few
    of_all = [Finding("warning", "all runs", None, f"current_{i}_a", f"looks {i} times", "look") for i in range(6)]
    assert at_a_glance(of_all) == of_all


def test_a_file_in_place_of_a_folder_is_said(tmp_path: Path) -> None:
    (file := tmp_path / "log.csv").write_text("a,b\n1,2\n")
    (error,) = check_campaign(file).errors
    assert "log.csv is a file, not a folder" in str(error)


def test_a_limit_is_one_sentence(tmp_path: Path) -> None:
    (file := tmp_path / "x").write_bytes(bytes(12_345))
    with pytest.raises(FileFault, match="has 12 345 bytes, more than 1 000 bytes"):
        expect_plain(file, Limit("BENCH_MOST_X", 1000, "bytes", ""))
