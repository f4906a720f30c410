"""What a command writes has a name and a place."""

from pathlib import Path

import pytest

from bench.cli.nameable import expect_nameable
from bench.errors import InputError


def test_a_folder_that_is_gone_is_no_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`bench hide -o out` in a folder that was deleted meanwhile ended in a traceback."""
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    with pytest.raises(InputError, match="out: the folder that this runs in is gone"):
        expect_nameable(("hide",), Path("out"))
    expect_nameable(("hide",), tmp_path / "out")
