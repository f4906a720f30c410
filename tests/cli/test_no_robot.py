"""Folders from which no robot can be had say why; "unknown robot" was all that was said."""

import os
import shutil
from pathlib import Path

import pytest

from bench.cli import main
from bench.record.write import write_campaign
from bench.report.diagnosis.file_names import VERDICT
from bench.report.dynamics.file_names import DYNAMICS
from bench.robot.folder import FIGURES_FILE, load_robot
from tests.diagnose.sweeps import SWEEP, made


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("machine") / "may"
    write_campaign(made(SWEEP, 1), folder)
    return folder


@pytest.mark.parametrize(
    "words",
    [
        ["predict", "OF", "MAY"],
        ["apply", "OF", "-o", "OUT"],
        ["compare", "MAY", "MAY", "--robot", "OF"],
        ["diagnose", "MAY", "--given", "OF", "-o", "OUT"],
    ],
    ids=lambda words: words[0],
)
def test_a_diagnosis_that_handed_none_over(
    campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str]
) -> None:
    found, out = tmp_path / "found", tmp_path / "out"
    found.mkdir()
    (found / VERDICT).write_text("{}")  # all that one leaves, with its page, that ended before anything was weighed
    names = {"OF": str(found), "MAY": str(campaign), "OUT": str(out)}
    assert main([names.get(word, word) for word in words]) == 4
    assert f"{found}: this diagnosis handed no robot over" in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("words", [["predict", "OF", "MAY"], ["apply", "OF", "-o", "OUT"]], ids=lambda words: words[0])
def test_a_first_pass(campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str]) -> None:
    """It was "unknown robot 'first-pass'. Known: emps, hh150, kr300"."""
    found, out = tmp_path / "first-pass", tmp_path / "out"
    found.mkdir()
    (found / DYNAMICS).write_text("{}")
    names = {"OF": str(found), "MAY": str(campaign), "OUT": str(out)}
    assert main([names.get(word, word) for word in words]) == 4
    assert f"{found}: a first pass hands no robot over; `bench diagnose" in capsys.readouterr().err


def test_motion_alone_has_no_stiffness_and_says_what_it_has(campaign: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["identify", str(campaign)]) != 0
    assert "--method dynamics" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda file: (file.unlink(), file.symlink_to(file.name)), "symbolic links"),
        (lambda file: (file.unlink(), file.mkdir()), "is a folder"),
        (lambda file: (file.unlink(), os.mkfifo(file)), "is a named pipe"),
    ],
    ids=["loop", "folder", "pipe"],
)
def test_a_folder_that_cannot_be_read(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], spoil: object, said: str
) -> None:
    assert callable(spoil)
    shutil.copytree(load_robot("hh150").folder, tmp_path / "arm")
    spoil(tmp_path / "arm" / FIGURES_FILE)
    assert main(["apply", str(tmp_path / "arm"), "-o", str(tmp_path / "out")]) == 4
    printed = capsys.readouterr().err
    assert said in printed
    assert "unknown robot" not in printed
