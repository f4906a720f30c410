"""A clock that counts rows beside clocks that count seconds."""

from pathlib import Path

import numpy as np
import pytest

from bench.record.campaign import Array
from bench.record.check import check_campaign
from tests.record.build import STEP_S, motion, sweep, write_folder

MANIFEST = (
    "format: 1\nrobot: r\nruns:\n- {name: a, kind: motion, start_s: 0}\n"
    "- {name: b, kind: motion, start_s: 60, file: runs/b.csv}\n"
    "- {name: c, kind: motion, start_s: AT, file: runs/c.csv}\n"
)


def campaign(place: Path, slow: dict[str, Array], third_at: float) -> Path:
    """Write two sweeps that are read every few milliseconds, and in between one of another clock."""
    folder = write_folder(place / "campaign", motion(sweep(2)))
    (folder / "runs" / "c.csv").write_bytes((folder / "runs" / "a.csv").read_bytes())
    other = write_folder(place / "other", motion(slow))
    (folder / "runs" / "b.csv").write_bytes((other / "runs" / "a.csv").read_bytes())
    first = write_folder(place / "first", motion(sweep(1)))
    (folder / "runs" / "a.csv").write_bytes((first / "runs" / "a.csv").read_bytes())
    (folder / "campaign.yaml").write_text(MANIFEST.replace("AT", str(third_at)))
    return folder


def doubts(folder: Path) -> list[str]:
    return [str(finding) for finding in check_campaign(folder).doubts if "row numbers?" in finding.remedy]


@pytest.mark.parametrize("third_at", [100, 9000])
@pytest.mark.parametrize("first", [0, 1])
def test_row_numbers_in_place_of_seconds_are_doubted(tmp_path: Path, first: int, third_at: float) -> None:
    counted = sweep(3)
    counted["time_s"] = first + np.arange(len(counted["time_s"]), dtype=np.float64)
    said = doubts(campaign(tmp_path, counted, third_at))
    assert any("runs/b.csv: time_s" in line for line in said)


def test_a_motion_that_is_read_once_a_second_is_none(tmp_path: Path) -> None:
    every = int(1 / STEP_S)
    slow = {name: np.tile(values[::every], 3) for name, values in sweep(3).items()}
    slow["time_s"] = np.arange(len(slow["time_s"]), dtype=np.float64)
    assert not doubts(campaign(tmp_path, slow, 100))


@pytest.mark.parametrize(("at", "is_doubted"), [("1e9", True), ("4e7", True), ("1.7e9", True), ("6e6", False)])
def test_a_run_that_starts_years_later_is_doubted(tmp_path: Path, at: str, is_doubted: bool) -> None:
    folder = write_folder(tmp_path / "campaign", motion(sweep(1)))
    file = folder / "campaign.yaml"
    file.write_text(file.read_text().replace("start_s: 0", f"start_s: {at}"))
    found = [finding.level for finding in check_campaign(folder).findings if finding.column == "start_s"]
    assert found == (["doubt"] if is_doubted else [])
