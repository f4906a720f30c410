"""A store, a robot, and a list of what is simulated."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from bench.diagnose.picture import signatures
from bench.diagnose.replay.replay import World
from bench.diagnose.replay.simulations import simulate_all
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.store.store import Store


@pytest.fixture(autouse=True)
def one_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BENCH_CORES", "1")


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "store")


@pytest.fixture
def compiled(small_robot: Path) -> CompiledRobot:
    return compile_robot(load_robot(small_robot))


@pytest.fixture
def simulated(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return a list that fills with what is simulated: the names of effects, and "nuisance"."""
    names: list[str] = []

    def noted(replay: Any, worlds: Sequence[World], progress: Any) -> Any:
        names.extend(world.acting[-1].effect.name if world.acting else "nuisance" for world in worlds)
        return simulate_all(replay, worlds, progress)

    monkeypatch.setattr(signatures, "simulate_all", noted)
    return names
