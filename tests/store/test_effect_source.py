"""What an effect is made of: its code, what its module holds, and the code of the bench."""

import ast
import os
from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.linearise import effect_source
from bench.diagnose.linearise.effect_source import MAKES_SIGNATURES, PACKAGE, source_of
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect
from bench.robot.compiled import CompiledRobot
from bench.store.store import Store
from tests.store.small_signatures import CATALOGUE, learned, same, sweep

OWN = """
import numpy as np
from bench.effects.effect import Effect, Parameter
from dataclasses import replace
HELP

class Own(Effect):
    name = "own"
    family = "own"
    title = physics = source = "own"
    parameters = (Parameter("size", "", 0.0, 0.1, 1.0, "how much"),)

    def distort(self, place, values, reading, trace, conditions):
        return replace(reading, current=reading.current + values["size"] * BODY)
"""


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ({"BODY": "1.0"}, {"BODY": "2.0"}),
        ({"HELP": "TABLE = np.loadtxt('FOLDER/table')", "BODY": "TABLE", "table": "1 2"}, {"table": "1 3"}),
        ({"HELP": "import helping", "BODY": "helping.SIZE", "helping.py": "SIZE = 1.0"}, {"helping.py": "SIZE = 2.0"}),
        (
            {"HELP": "from helping import size", "BODY": "size()", "helping.py": "def size(): return 1.0"},
            {"helping.py": "def size(): return 2.0"},
        ),
    ],
    ids=["its file", "a table read by it", "a module it uses", "a function it uses"],
)
def test_an_effect_of_a_user_counts_by_its_source(
    compiled: CompiledRobot,
    store: Store,
    simulated: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    before: dict[str, str],
    after: dict[str, str],
) -> None:
    monkeypatch.syspath_prepend(tmp_path)

    def own(parts: dict[str, str]) -> list[Effect]:
        import importlib
        import sys

        sys.modules.pop("helping", None)
        importlib.invalidate_caches()
        text = OWN.replace("HELP", parts.get("HELP", "")).replace("BODY", parts["BODY"])
        for name, content in (parts | {"own.py": text.replace("FOLDER", str(tmp_path))}).items():
            if name.islower():
                (tmp_path / name).write_text(content)
                os.utime(tmp_path / name, (0, len(simulated)))  # compiled files are told apart by time
        return [CATALOGUE["coulomb_level"], catalogue([tmp_path / "own.py"])["own"]]

    learned(compiled, store, sweep(), own(before))
    simulated.clear()
    learned(compiled, store, sweep(), own(before))
    assert simulated == []
    changed = own(before | after)
    found = learned(compiled, store, sweep(), changed)
    assert simulated == ["own"]
    assert same(found, learned(compiled, None, sweep(), changed))


def test_an_effect_that_nobody_can_compare_is_always_simulated(
    compiled: CompiledRobot, store: Store, simulated: list[str]
) -> None:
    effect = type(CATALOGUE["coulomb_level"])()
    effect.secret = object()  # type: ignore[attr-defined]
    with pytest.raises(TypeError, match="no digest"):
        source_of(effect)
    for _ in range(2):
        simulated.clear()
        learned(compiled, store, sweep(), [effect, CATALOGUE["joint_compliance"]])
    assert set(simulated) == {"coulomb_level"}


def test_the_state_of_an_effect_counts() -> None:
    one, other = type(CATALOGUE["coulomb_level"])(), type(CATALOGUE["coulomb_level"])()
    assert source_of(one) == source_of(other)
    other.nodes = np.arange(3.0)  # type: ignore[attr-defined]
    assert source_of(one) != source_of(other)


def test_all_code_that_makes_signatures_counts() -> None:
    """What that code imports is part of it as well, or does not change numbers."""
    harmless = {"errors", "paths", "record", "scenario", "store", "executor", "diagnose"}
    parts = {part.split("/")[0] for part in MAKES_SIGNATURES} | harmless
    for folder in MAKES_SIGNATURES:
        files = list((PACKAGE / folder).rglob("*.py"))
        assert files
        for file in files:
            for node in ast.walk(ast.parse(file.read_text())):
                if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("bench."):
                    words = node.module.split(".")
                    assert words[1] in parts, f"{file}: {node.module}"
                    assert words[1] != "diagnose" or "/".join(words[1:3]) in MAKES_SIGNATURES, f"{file}: {node.module}"


def test_a_changed_file_changes_the_source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for folder in MAKES_SIGNATURES:
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "one.py").write_text("x = 1\n")
    monkeypatch.setattr(effect_source, "PACKAGE", tmp_path)

    def source() -> str:
        effect_source.source_of_bench.cache_clear()
        return effect_source.source_of_bench()

    before = source()
    assert source() == before
    for folder in MAKES_SIGNATURES:
        (tmp_path / folder / "one.py").write_text("x = 2\n")
        after = source()
        assert after != before
        before = after
    effect_source.source_of_bench.cache_clear()
