"""An arm of which everything is off, as real ones are against public models: no doubts, and a first pass serves."""

import json
from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from tests import off_arm


def campaign(folder: Path, runs: int, seconds: float) -> Path:
    """Return a campaign of the arm, from its file and its logs by the commands of the page."""
    off_arm.write_logs(folder, np.random.default_rng(7), runs, seconds)
    assert main(["new-robot", "off", "--mjcf", str(folder / "arm.xml"), "-o", str(folder / "robot")]) == 0
    assert main(["convert", str(folder / "robot"), str(folder / "logs"), "-o", str(folder / "campaign")]) == 0
    return folder / "campaign"


def test_nothing_is_doubted_and_a_first_pass_serves(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made = campaign(tmp_path, runs=3, seconds=10)
    assert main(["check", str(made)]) == 0
    assert "0 errors, 0 warnings" in capsys.readouterr().out
    assert main(["identify", str(made), "--method", "dynamics", "-o", str(tmp_path / "first")]) == 0
    found = json.loads((tmp_path / "first" / "dynamics.json").read_text())
    assert all(
        ours < 0.2 * nominal
        for ours, nominal in zip(*(found["held_out_rms_nm"][key] for key in ("first_pass", "nominal")), strict=True)
    )
