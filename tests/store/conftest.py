"""A store, a robot, and a list of what is simulated."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from bench.diagnose.linearise.signatures import Signatures
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
    simulate = Signatures._simulate

    def noted(self: Signatures, changes: Any, which: Sequence[int], *about: Any) -> None:
        plan = [one.effect.name for one in self.plan]
        names.extend((["nuisance"] * len(self.nuisances) + plan)[i] for i in which)
        simulate(self, changes, which, *about)

    monkeypatch.setattr(Signatures, "_simulate", noted)
    return names
