"""The page about the environment: its code runs."""

import re
from pathlib import Path

import pytest

import bench.environment

README = (Path(bench.environment.__file__).parent / "README.md").read_text(encoding="utf-8")


def test_code_runs(found: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(found.parent)
    names: dict[str, object] = {}
    blocks = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    assert len(blocks) == 4
    for code in blocks:
        exec(compile(code, "README.md", "exec"), names)
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 4
    assert len(set(lines[1:])) == 3, "each reset drew another robot"
