"""Numbers on a command line that mean nothing end in one sentence, not in a traceback."""

import sys
from pathlib import Path

import pytest

from bench.cli import main


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["hide", "--none", "--seed", "-1"], "--seed -1: a seed is a whole number from 0 on"),
        (["hide", "--none", "--machine", "-1"], "--machine -1: a seed is a whole number from 0 on"),
        (["run", "loading", "--seed", "-1"], "--seed -1: a seed is a whole number from 0 on"),
        (["poses", "--robot", "hh150", "--seed", "-1"], "--seed -1: a seed is a whole number from 0 on"),
        (["demo", "--seed", "-1"], "--seed -1: a seed is a whole number from 0 on"),
        (["study", "--seed", "-1"], "--seed -1: a seed is a whole number from 0 on"),
        (["study", "--cores", "-1"], "--cores -1: give how many cores to use, or 0 for all"),
        (["study", "--nulls", "-5", "--seeds", "-1"], "seeds -1: give a number of campaigns, 0 or more"),
        (["study", "--nulls", "-5"], "nulls -5: give a number of campaigns, 0 or more"),
        (["study", "--recordings", "2", "--seeds", "-1"], "seeds -1: give a number of campaigns, 0 or more"),
        (["poses", "--robot", "hh150", "-n", "0"], "-n 0: give how many poses to choose, 1 or more"),
        (["poses", "--robot", "hh150", "--margin-deg", "nan"], "--margin-deg nan: must be an angle of 0 to 180 deg"),
        (["poses", "--robot", "hh150", "--floor-m", "inf"], "--floor-m inf: must be a finite height"),
        (["poses", "--robot", "hh150", "--slanting", "-3"], "--slanting -3: must be a number of poses of 0 or more"),
        (["hide", "gas_loss=nan"], "'nan' is not a number"),
        (["hide", "gas_loss=inf"], "'inf' is not a number"),
        (["hide", "gas_loss=5"], "beyond it means nothing"),
        (["hide", "gas_loss=12"], "lost is at most 1; beyond it means nothing; a share of 2 % is written 0.02"),
        (["hide", "gas_loss=12%"], "'12%' is not a number; a share of 2 % is written 0.02"),
        (["hide", "gas_temperature=-300"], "beyond it means nothing"),
        (["hide", "anchor=-2"], "no robot can be simulated with anchor=-2"),
    ],
)
def test_it_is_bad_input(words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*words, "-o", str(tmp_path / "out")]) == 2
    assert said in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_file_of_effects_that_exits_does_not_end_the_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "own.py").write_text("raise SystemExit(0)\n")
    assert main(["diagnose", str(tmp_path), "-o", str(tmp_path / "out"), "--file", str(tmp_path / "own.py")]) == 2
    assert "does not run: SystemExit" in capsys.readouterr().err


@pytest.mark.skipif(sys.platform != "linux", reason="there is no /dev/full")
def test_output_that_cannot_be_written_is_one_sentence(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with Path("/dev/full").open("w", buffering=1) as full, monkeypatch.context() as patch:
        patch.setattr(sys, "stdout", full)
        assert main(["robots"]) == 2
    assert "what it prints cannot be written" in capfd.readouterr().err
