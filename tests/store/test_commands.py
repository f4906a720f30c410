"""Commands that simulate signatures hand the user's store on, unless they are told not to."""

from pathlib import Path
from typing import Any

import pytest

from bench.cli import main
from bench.errors import InputError
from bench.record.write import write_campaign
from bench.store.place import open_store
from tests.diagnose.sweeps import SWEEP, made


def spy_on(monkeypatch: pytest.MonkeyPatch, place: Any, name: str) -> list[object]:
    """Replace a function by one that notes its store and ends the command; return what was noted."""
    stores: list[object] = []

    def spy(*arguments: object, store: object, **named: object) -> object:
        stores.append(store)
        raise InputError("enough seen.")

    monkeypatch.setattr(place, name, spy)
    return stores


def test_diagnose(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import bench.diagnose.diagnose as module

    write_campaign(made(SWEEP, seed=5), tmp_path / "campaign")
    stores = spy_on(monkeypatch, module, "diagnose")
    command = ["diagnose", str(tmp_path / "campaign"), "-o", str(tmp_path / "out")]
    assert main(command) == main([*command, "--no-store"]) == 2
    assert stores == [open_store(), None]
