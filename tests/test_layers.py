"""Import arrows run one way.

errors <- executor, record <- robot <- {simulate, identify} <- {hide, diagnose} <- {compare, predict} <- {study,
benchmark} <- report <- {environment, cli}.
"""

import ast
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "bench"

# What each part of the package may import from the others, besides itself.
BELOW = {"errors", "executor", "paths", "record", "actuators", "robot"}
MAY_IMPORT = {
    "__init__": set(),
    "errors": set(),
    "executor": {"errors"},
    "paths": {"errors"},
    "actuators": {"errors"},
    "record": {"errors"},
    "store": {"errors"},
    "robot": {"errors", "paths", "record", "actuators"},
    "scenario": {"errors", "paths", "record", "robot"},
    "simulate": {"errors", "paths", "record", "actuators", "robot", "scenario"},
    "identify": {"errors", "paths", "record", "actuators", "robot"},
    "effects": BELOW | {"simulate"},
    "second": {"errors", "record", "robot"},
    "hide": BELOW | {"simulate", "scenario", "effects", "second"},
    "diagnose": BELOW | {"store", "simulate", "effects", "identify"},
    "compare": BELOW | {"store", "simulate", "effects", "diagnose"},
    "predict": BELOW | {"simulate", "effects", "diagnose"},
    "study": BELOW
    | {"store", "simulate", "scenario", "effects", "second", "hide", "identify", "diagnose", "compare", "predict"},
    "benchmark": BELOW | {"simulate", "scenario", "effects", "hide", "identify", "diagnose"},
    "report": BELOW
    | {"scenario", "simulate", "identify", "effects", "hide", "diagnose", "compare", "predict", "study"},
    "environment": BELOW | {"simulate", "effects", "diagnose", "report"},
    "cli": BELOW
    | {
        "store",
        "scenario",
        "simulate",
        "identify",
        "effects",
        "hide",
        "diagnose",
        "compare",
        "predict",
        "study",
        "benchmark",
        "report",
    },
}
# Steps of a diagnosis, each may import those before it
STEPS_OF_DIAGNOSIS = ("replay", "linearise", "extend", "cross_validation", "name", "baseline", "experiment_design")
ENGINES_OF = {
    "identify": {"mujoco", "gymnasium"},
    "second": {"mujoco", "gymnasium"},
    "record": {"mujoco", "pinocchio", "gymnasium"},
}
PLAIN_OF_ROBOT = {"bodies", "figures", "instruments"}  # all that the second plant may have of it: numbers
TRUTH_READERS = {"report/scoring.py"}


def part_of(file: Path) -> str:
    return file.relative_to(PACKAGE).parts[0].removesuffix(".py")


@cache
def imports_of(file: Path) -> tuple[str, ...]:
    return tuple(_imports_of(file))


def _imports_of(file: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: imports are absolute here"
            assert node.module
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


SOURCES = sorted(PACKAGE.rglob("*.py"))


@pytest.mark.parametrize("file", SOURCES, ids=lambda file: str(file.relative_to(PACKAGE)))
def test_imports_point_down(file: Path) -> None:
    part = part_of(file)
    allowed = MAY_IMPORT[part] | {part}
    for name in imports_of(file):
        words = name.split(".")
        if words[0] == "bench" and len(words) > 1 and (PACKAGE / words[1]).exists():
            assert words[1] in allowed, f"{part} may not import bench.{words[1]}"
        assert words[0] not in ENGINES_OF.get(part, set()), f"{part} may not import {words[0]}"


@pytest.mark.parametrize("step", [*STEPS_OF_DIAGNOSIS, "plausibility"])
def test_steps_of_a_diagnosis_rest_on_those_before(step: str) -> None:
    before = STEPS_OF_DIAGNOSIS[: 1 if step == "plausibility" else STEPS_OF_DIAGNOSIS.index(step)]
    files = sorted((PACKAGE / "diagnose" / step).glob("*.py"))
    assert len(files) > 1
    for file in files:
        for name in imports_of(file):
            words = name.split(".")
            if words[:2] == ["bench", "diagnose"] and len(words) > 2:
                is_shared = step == "plausibility" and words[2:4] in (["linearise", "changes"], ["linearise", "plan"])
                assert words[2] in (*before, step) or is_shared, f"{file.name} may not import {name}"


@pytest.mark.parametrize("file", SOURCES, ids=lambda file: str(file.relative_to(PACKAGE)))
def test_only_scoring_reads_truth(file: Path) -> None:
    if str(file.relative_to(PACKAGE)) not in TRUTH_READERS:
        assert "bench.record.truth.read_truth" not in set(imports_of(file))


def test_second_plant_takes_plain_numbers_only() -> None:
    for file in sorted((PACKAGE / "second").glob("*.py")):
        for name in imports_of(file):
            words = name.split(".")
            if words[:2] == ["bench", "robot"] and len(words) > 2:
                assert words[2] in PLAIN_OF_ROBOT, f"{file.name} may not import {name}"


def test_identification_runs_without_mujoco() -> None:
    probe = (
        "import sys; sys.modules['mujoco'] = None; import pkgutil, importlib, bench.identify;"
        "names = [m.name for m in pkgutil.walk_packages(bench.identify.__path__, 'bench.identify.')];"
        "assert 'bench.identify.dynamics.first_pass' in names; [importlib.import_module(name) for name in names]"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", probe], check=True)
