"""`bench diagnose` with what a lab gets wrong: each ends in one named error and its exit code, and leaves nothing."""

import json
import re
import shutil
from pathlib import Path

import pytest

from bench.cli import main
from bench.cli.stopping import UNFINISHED
from bench.report.diagnosis.file_names import VERDICT
from tests.found import write_found
from tests.small_robot import write_small_robot

OWN = """
from bench.effects.effect import Parameter, Effect


class Own(Effect):
    name = "own"
    family = "own"
    title = "own"
    physics = "own"
    source = "own"
    parameters = (Parameter("size", "", 0.0, 0.1, 1.0, "how much"),)

    def edit(self, place, values, conditions):
        return BODY
"""


@pytest.fixture
def campaign(healthy: Path, tmp_path: Path) -> Path:
    """Return a copy to spoil."""
    return Path(shutil.copytree(healthy, tmp_path / "campaign"))


def spoil(campaign: Path, column: str, factor: float) -> None:
    for table in (campaign / "runs").iterdir():
        head, *rows = [line.split(",") for line in table.read_text().splitlines()]
        at = head.index(column)
        for row in rows:
            row[at] = str(factor * float(row[at]))
        table.write_text("\n".join(",".join(row) for row in [head, *rows]) + "\n")


def refused(campaign: Path, out: Path, *more: str) -> tuple[int, list[str]]:
    """Diagnose; return the exit code and what is left beside the campaign."""
    code = main(["diagnose", str(campaign), "-o", str(out), *more])
    return code, sorted(entry.name for entry in out.parent.iterdir() if entry.name.startswith((".", out.name)))


@pytest.mark.parametrize(
    ("column", "factor", "said"),
    [
        ("current_2_a", -1.0, "current_2_a: has the wrong sign"),
        ("current_2_a", 1e3, r"milliamperes\? multiply by 0\.001"),
        ("current_2_a", float("nan"), r"row 1 \(line 2\): current_2_a: no value"),
        ("q_motor_2_rad", 57.29578, r"q_motor_2_rad: .*degrees\?"),
        ("current_2_a", 0.0, "is 0 in every row while q_motor_2_rad changes"),
        ("time_s", -1.0, "time_s: runs backwards, rows 2 to"),
    ],
)
def test_poisoned_column_ends_in_a_named_error(
    campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], column: str, factor: float, said: str
) -> None:
    spoil(campaign, column, factor)
    assert main(["check", str(campaign)]) == 3
    assert re.search(said, capsys.readouterr().out)
    assert refused(campaign, tmp_path / "out") == (3, [])
    assert re.search(said, capsys.readouterr().err)


def test_campaign_of_another_robot(campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    manifest = campaign / "campaign.yaml"
    manifest.write_text(manifest.read_text().replace("hh150", "emps"))
    assert refused(campaign, tmp_path / "out") == (3, [])
    assert "has 1 drive" in capsys.readouterr().err


def test_recordings_of_two_robots(
    healthy: Path, campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree("models/hh150", campaign / "robot")
    manifest = campaign / "campaign.yaml"
    manifest.write_text(manifest.read_text().replace("robot: hh150", "robot: robot"))
    assert main(["diagnose", str(healthy), str(campaign), "-o", str(tmp_path / "out")]) == 3
    assert not (tmp_path / "out").exists()
    assert "one machine" in capsys.readouterr().err


def test_a_recording_that_is_given_twice(healthy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["diagnose", str(healthy), str(healthy), "-o", str(tmp_path / "out")]) == 2
    assert "given twice" in capsys.readouterr().err


def test_recordings_are_called_by_their_folders(
    healthy: Path, campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    command = ["diagnose", str(healthy), str(campaign), "-o", str(out), "--at-most", "0.01"]
    assert main(command) == 3  # one is a copy of the other
    assert "hold the same readings as those of healthy" in capsys.readouterr().err
    assert main([*command, "--despite-doubts"]) == UNFINISHED
    runs = json.loads((out / VERDICT).read_text())["data"]["runs"]
    assert {run["name"].split(".")[0] for run in runs} == {"healthy", "campaign"}


@pytest.mark.parametrize(("content", "said"), [("", "runs/.*: .*empty"), ("time_s,pose\n0\n", "row 1")])
def test_broken_table(
    campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], content: str, said: str
) -> None:
    next((campaign / "runs").iterdir()).write_text(content)
    assert refused(campaign, tmp_path / "out") == (3, [])
    assert re.search(said, capsys.readouterr().err)


def test_results_that_stand_there_are_not_touched(
    campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "mine.txt").write_text("precious")
    assert refused(campaign, out) == (2, ["out"])
    assert "not empty" in capsys.readouterr().err
    assert [entry.name for entry in out.iterdir()] == ["mine.txt"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (OWN.replace("return BODY", "return )"), r"own\.py:14: does not run: SyntaxError"),
        (OWN.replace("BODY", "1 / 0"), r"own\.py:14: effect 'own': edit raised ZeroDivisionError"),
        (OWN.replace("BODY", "lambda spec, robot: spec.nothing"), r"own\.py:14: effect 'own': the change from edit"),
        (OWN.replace("BODY", "3"), r"effect 'own': edit must return a function"),
        (OWN.replace('family = "own"', 'family = "mine"'), r"class Own: family 'mine' is unknown"),
        (OWN.replace("),)\n", "))\n"), "must be a tuple of Parameter"),
    ],
)
def test_own_effect_that_fails_is_named_with_its_line(
    healthy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, said: str
) -> None:
    file = tmp_path / "own.py"
    file.write_text(text)
    assert refused(healthy, tmp_path / "out", "--file", str(file)) == (2, [])
    assert re.search(said, capsys.readouterr().err)


@pytest.mark.parametrize(
    ("file", "old", "new", "said"),
    [
        ("figures.yaml", "rotor: rotor2", "rotor: rotor9", "rotor9"),
        ("figures.yaml", "joint: joint2", "joint: elbow", "elbow"),
        ("hh150.xml", 'mass="270"', 'mass="-270"', "mass"),
    ],
)
def test_robot_with_a_mistake(
    campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], file: str, old: str, new: str, said: str
) -> None:
    robot = Path(shutil.copytree("models/hh150", campaign / "robot"))
    text = (robot / file).read_text()
    assert old in text
    (robot / file).write_text(text.replace(old, new, 1))
    manifest = campaign / "campaign.yaml"
    manifest.write_text(manifest.read_text().replace("robot: hh150", "robot: robot"))
    assert refused(campaign, tmp_path / "out") == (4, [])
    assert said in capsys.readouterr().err


def test_moving_data_begin_with_a_first_pass(healthy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Whatever becomes of the diagnosis."""
    code = main(["diagnose", str(healthy), "-o", str(tmp_path / "out"), "--at-most", "10"])
    assert code in (0, UNFINISHED)
    first, head, *rows = capsys.readouterr().out.splitlines()
    assert first.startswith("First pass: least squares of the rigid dynamics over 35 s of motion. Torque, ")
    assert first.endswith(" [Nm] on 4 whole runs, each predicted without it:")
    assert head.split() == [word for drive in range(1, 7) for word in ("drive", str(drive))]
    names = ["torque itself", "nominal model", "plain least squares", "first pass"]
    for name, row in zip(names, rows[:4], strict=True):
        assert row.strip().startswith(name)
        errors = row.removeprefix(f"  {name}").split()
        assert [error == "-" for error in errors] == [True, False, True, True, True, True]  # joint 2 alone moves


@pytest.mark.parametrize("text", ["", "soon", "-1", "0", "5x", "1e3", "60 s s"])
def test_what_is_no_time_is_refused(
    text: str, healthy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert refused(healthy, tmp_path / "out", f"--at-most={text}") == (2, [])
    assert "give seconds, minutes or hours, as 90, 60s, 2m or 1h" in capsys.readouterr().err


def test_given_needs_what_a_diagnosis_left(healthy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert refused(healthy, tmp_path / "out", "--given", str(tmp_path)) == (4, [])
    assert "posterior.json: does not exist" in capsys.readouterr().err
    assert refused(healthy, tmp_path / "out", "--given", str(tmp_path), "--robot", "hh150") == (2, [])
    assert "--given and --robot" in capsys.readouterr().err


def test_given_of_another_robot_is_asked_about(
    healthy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_found(write_small_robot(tmp_path / "robot"), tmp_path / "found")
    assert refused(healthy, tmp_path / "out", "--given", str(tmp_path / "found")) == (3, [])
    assert "was that found on the robot of these campaigns?" in capsys.readouterr().err
