"""An arm of which everything is off, as real ones are against public models: no doubts, no worse than least squares."""

import json
from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from tests import off_arm

SURE = 0.97
# Friction laws that act in every joint, and what stands for its masses, centres, inertias, rotors, offsets and scales
TRUE = {
    *("coulomb_friction", "viscous_friction", "stribeck", "load_friction", "direction_friction", "torque_offset"),
    *("link_mass", "link_com", "link_inertia", "rotor_inertia", "torque_constant", "unstated_payload"),
}


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


@pytest.mark.study
def test_a_diagnosis_predicts_no_worse_than_least_squares(tmp_path: Path) -> None:
    made = campaign(tmp_path, runs=4, seconds=20)
    assert main(["diagnose", str(made), "-o", str(tmp_path / "found")]) == 0
    verdict = json.loads((tmp_path / "found" / "verdict.json").read_text())
    for drive in verdict["baseline"]["drives"]:
        assert drive["diagnosed"] < min(drive["plain_least_squares"], drive["first_pass"])
    assert verdict["findings"]
    named = [one for group in verdict["findings"] for one in group["names"] if one["probability"] >= SURE]
    assert {one["cause"]["effect"] for one in named} <= TRUE
