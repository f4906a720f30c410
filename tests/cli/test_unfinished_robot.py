"""Who takes a robot whose diagnosis ended before it was done is told so by every command that takes it."""

import shutil
from pathlib import Path

import pytest

from bench.cli import main
from bench.record.write import write_campaign
from bench.robot.folder import FIGURES_FILE, load_robot
from tests.diagnose.sweeps import SWEEP, made

SAID = "the diagnosis that fitted this robot ended before it was done"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("machine")
    shutil.copytree(load_robot("hh150").folder, folder / "robot")
    with (folder / "robot" / FIGURES_FILE).open("a", encoding="utf-8") as file:
        file.write("\nfitted:\n  unfinished: ended after 540 s\n")
    write_campaign(made(SWEEP, 1), folder / "may")
    write_campaign(made(SWEEP, 2), folder / "june")
    return folder


@pytest.mark.parametrize("command", ["predict", "compare", "apply"])
def test_it_is_said_once(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str) -> None:
    robot, may, june = (str(folder / name) for name in ("robot", "may", "june"))
    options = ["--no-store", "--cores", "1"]
    arguments = {
        "predict": [robot, may],
        "compare": [may, june, "--robot", robot, "--at-most", "1s", *options],
        "apply": [robot, "-o", str(tmp_path / "applied")],
    }
    main([command, *arguments[command]])
    assert capsys.readouterr().err.count(SAID) == 1
    if command == "predict":
        main([command, "hh150", may])
        assert SAID not in capsys.readouterr().err
