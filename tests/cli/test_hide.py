"""`bench hide`: campaign and truth apart, errors by name."""

import sys
from pathlib import Path
from types import ModuleType

import pytest
import yaml

from bench.cli import main
from bench.record.truth import read_truth
from tests.hide.tiny import CATALOGUE
from tests.simulate.session_small import small_session


@pytest.fixture
def scenario(small_robot: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    stand_in = ModuleType("bench.effects.catalogue")
    stand_in.catalogue = lambda: CATALOGUE  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "bench.effects.catalogue", stand_in)
    file = tmp_path / "mine.yaml"
    content = small_session(small_robot, line=None, rotations=[], repeat_at_end=None).model_dump(mode="json")
    file.write_text(yaml.safe_dump(content))
    return file


def test_hides_an_effect(scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert main(["hide", "level@2=0.4", "warmth", "--scenario", str(scenario), "--seed", "3", "-o", str(out)]) == 0
    assert {entry.name for entry in out.iterdir()} == {"campaign", "truth"}
    assert read_truth(out / "truth").effects == ("level joint 2", "warmth")
    assert "level (joint 2): rise 0.4" in capsys.readouterr().out
    assert main(["check", str(out / "campaign")]) == 0
    assert "0 errors, 0 warnings" in capsys.readouterr().out
    assert not any("level" in file.read_text() for file in (out / "campaign").rglob("*.*"))


def test_hides_nothing(scenario: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert main(["hide", "--none", "--scenario", str(scenario), "-o", str(out)]) == 0
    assert read_truth(out / "truth").effects == ()


def test_leaves_out_what_the_lab_does_not_have(scenario: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    arguments = ["hide", "--none", "--scenario", str(scenario), "--without", "tracker", "dwell", "-o", str(out)]
    assert main(arguments) == 0
    tables = list((out / "campaign" / "runs").iterdir())
    assert {table.name for table in tables} == {"pose1-from-below.csv", "pose1-from-above.csv"}
    assert not any("reflector" in table.read_text() for table in tables)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["levle"], "Did you mean 'level'"),
        (["level"], "say where with @ or --joint"),
        ([], "name an effect to hide"),
        (["level@1", "--none"], "not both"),
    ],
)
def test_what_cannot_be_hidden(
    arguments: list[str], said: str, scenario: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["hide", *arguments, "--scenario", str(scenario), "-o", str(out)]) == 2
    assert said in capsys.readouterr().err
    assert not out.exists()
