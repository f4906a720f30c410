"""A store, a robot, and a list of what is simulated."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from bench.diagnose.linearise import changes
from bench.diagnose.linearise.plan import Plan
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.store.store import Store


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "store")


@pytest.fixture
def compiled(small_robot: Path) -> CompiledRobot:
    return compile_robot(load_robot(small_robot))


@pytest.fixture
def simulated(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return a list that fills with what is not read from the store: the names of effects, and "nuisance"."""
    names: list[str] = []
    simulate = changes._simulate

    def noted(columns: Any, which: Sequence[int], plan: Plan, *about: Any) -> None:
        every = ["nuisance"] * len(plan.nuisances) + [one.effect.name for one in plan.acting]
        names.extend(every[i] for i in which)
        simulate(columns, which, plan, *about)

    monkeypatch.setattr(changes, "_simulate", noted)
    return names
