"""models/own-robot.md: its commands, in its order, lead from a stranger's MJCF and logs to a diagnosis."""

import json
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from tests import stranger

PAGE = (Path(__file__).parents[1] / "models" / "own-robot.md").read_text(encoding="utf-8")
LINES = [line for block in re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL) for line in block.splitlines()]
SECONDS, LOGS, PAYLOAD = 12.0, 3, 2.5
TIME_UP = 7  # exit code of a diagnosis that was ended by --at-most
SHORT = "3s"  # in place of what the page gives a diagnosis; the test is whether the command works on such a folder


def quantity(found: dict[str, list[dict[str, object]]], name: str) -> tuple[float, float]:
    (interval,) = [q["interval"] for q in found["quantities"] if q["name"] == name]
    low, high = interval  # type: ignore[misc]
    return float(low), float(high)


def test_the_page_from_its_first_command_to_its_last(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.xml").write_text(stranger.mjcf())
    (tmp_path / "logs").mkdir()
    rng = np.random.default_rng(11)
    for k in range(LOGS):
        motion = stranger.moved(rng, SECONDS, payload=PAYLOAD)
        stranger.ur_log(tmp_path / "logs" / f"run{k}.csv", motion, separator=";", decimal=",")
    commands = [shlex.split(line) for line in LINES]
    assert [words[1] for words in commands if words[0] == "bench"] == [
        *("new-robot", "convert", "convert", "check", "identify", "diagnose")
    ]
    for words in commands:
        if words[0] == "cp":
            shutil.copyfile(*words[1:])
            continue
        words = [SHORT if before == "--at-most" else word for before, word in zip(["", *words], words, strict=False)]
        code = main(words[1:])
        said = capsys.readouterr()
        assert code == 0 or (words[1] == "diagnose" and code == TIME_UP), said.err
        if words[1] == "check":
            assert said.out.startswith("assumed ")
            assert "0 errors, 0 warnings" in said.out
    found = json.loads((tmp_path / "first-pass" / "dynamics.json").read_text())
    low, high = quantity(found, "unstated payload")
    assert low < PAYLOAD < high
    assert high - low < 1.5
    for joint, coulomb in enumerate(stranger.COULOMB):
        low, high = quantity(found, f"Coulomb friction (j{joint + 1})")
        assert 0.9 * coulomb < low < high < 1.1 * coulomb
    assert all(rms < 0.5 for rms in found["held_out_rms_nm"]["first_pass"])
    assert (tmp_path / "found" / "report.html").is_file()
    assert (tmp_path / "found" / "verdict.json").is_file()
