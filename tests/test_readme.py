"""README.md: its code runs, its commands exist, its links lead somewhere."""

import re
import tomllib
from pathlib import Path

import pytest

from bench.cli import main
from bench.scenario.files import scenario_names

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_python_code_runs(capsys: pytest.CaptureFixture[str]) -> None:
    for code in re.findall(r"```python\n(.*?)```", README, re.DOTALL):
        exec(compile(code, "README.md", "exec"), {})
    assert "[" in capsys.readouterr().out


@pytest.mark.parametrize("command", sorted(set(re.findall(r"`bench ([\w-]+)", README))))
def test_commands_exist(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main([command, "--help"])
    assert ended.value.code == 0
    assert f"bench {command}" in capsys.readouterr().out


PAGES = sorted(page.relative_to(ROOT) for folder in ("bench", "models") for page in (ROOT / folder).rglob("*.md"))


@pytest.mark.parametrize("page", [Path("README.md"), Path("CHANGELOG.md"), Path("CONTRIBUTING.md"), *PAGES], ids=str)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#:]+)\)", (ROOT / page).read_text(encoding="utf-8")):
        assert (ROOT / page.parent / target).exists(), target


def test_scenarios_are_named() -> None:
    for name in scenario_names():
        assert f"`{name}`" in README


def test_versions_agree() -> None:
    from bench import __version__

    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert project["version"] == __version__
    assert f"## {__version__}" in (ROOT / "CHANGELOG.md").read_text()
