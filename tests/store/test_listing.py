"""`bench store`: what it says, and its limit."""

import os
from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from bench.errors import InputError
from bench.store.digest import digest
from bench.store.listing import age_words, size_words
from bench.store.place import bytes_of, open_store, store_folder


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("BENCH_STORE", str(tmp_path / "store"))
    return tmp_path / "store"


def test_it_lists_what_is_there(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for i in range(3):
        open_store().put(digest(i), {"x": np.ones(10_000)}, label=f"robot {i // 2}")
    (folder / f"{digest(9)}.entry").write_bytes(b"broken")
    assert main(["store"]) == 0
    said = capsys.readouterr().out
    assert str(folder) in said
    assert "240 kB of 2 GB at most" in said or "241 kB of 2 GB at most" in said
    assert "2 entries" in said
    assert said.count("robot 0") == said.count("robot 1") == said.count("damaged") == 1


def test_it_clears(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    open_store().put(digest(1), {"x": np.ones(10)})
    (folder / f"{digest(9)}.entry").write_bytes(b"")
    assert main(["store", "--clear"]) == 0
    assert "0 bytes of 2 GB" in capsys.readouterr().out
    assert not list(folder.glob("*.entry"))


def test_a_limit_stays(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for i in range(4):
        open_store().put(digest(i), {"x": np.ones(10_000)})
    assert main(["store", "--limit", "200 kB"]) == 0
    assert "200 kB at most" in capsys.readouterr().out
    assert len(open_store().entries()) == 2
    assert open_store().limit_bytes == 200_000
    (folder / "limit").write_text("much")
    assert open_store().limit_bytes == 2_000_000_000


def test_a_limit_without_a_unit_removes_nothing(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Five was taken for five bytes, and all that was kept was gone."""
    open_store().put(digest(1), {"x": np.ones(10)})
    assert main(["store", "--limit", "5"]) == 2
    assert "5MB" in capsys.readouterr().err
    assert len(open_store().entries()) == 1
    assert not (folder / "limit").exists()


def test_a_limit_holds_only_where_it_could_be_set(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Under a lock that is none the command failed, and what it had written was the limit of the next one."""
    open_store().put(digest(1), {"x": np.ones(10)})
    (folder / "lock").unlink()
    (folder / "lock").mkdir()
    assert main(["store", "--limit", "5kB"]) == 2
    assert f"{folder / 'lock'}: cannot be written" in capsys.readouterr().err
    assert open_store().limit_bytes == 2_000_000_000


@pytest.mark.parametrize("said", ["much", "5_0", "-5", "9" * 5000])
def test_a_limit_that_is_none_does_not_count(folder: Path, said: str) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "limit").write_text(said)
    assert open_store().limit_bytes == 2_000_000_000


def test_a_pipe_in_place_of_the_limit_is_not_waited_for(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    os.mkfifo(folder / "limit")
    assert open_store().limit_bytes == 2_000_000_000


def test_a_pipe_in_place_of_an_entry_is_not_waited_for(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    os.mkfifo(folder / f"{digest(1)}.entry")
    assert open_store().get(digest(1)) is None
    os.mkfifo(folder / f"{digest(2)}.entry")
    assert [entry.label for entry in open_store().entries()] == [""]


def test_a_store_that_was_never_used(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["store", "--clear"]) == 0
    assert "0 bytes" in capsys.readouterr().out
    assert not folder.exists()


def test_what_cannot_be_done_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("BENCH_STORE", str(tmp_path / "file"))
    assert main(["store", "--limit", "5MB"]) == 2
    assert "cannot be written" in capsys.readouterr().err
    assert main(["store", "--limit", "5 parsecs"]) == 2
    assert "is no size" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "size"), [("500MB", 500_000_000), ("2 GB", 2 * 10**9), ("1.5k", 1500), ("17B", 17), ("20 b", 20), ("0", 0)]
)
def test_sizes(text: str, size: int) -> None:
    assert bytes_of(text) == size


@pytest.mark.parametrize("text", ["", "GB", "-5MB", "5TB", "1e6", "5", "800000", "\u0665MB"])
def test_what_is_no_size(text: str) -> None:
    with pytest.raises(InputError):
        bytes_of(text)


def test_words() -> None:
    assert [size_words(size) for size in (0, 999, 1000, 31_317_851, 2e9, 5e12)] == [
        "0 bytes", "999 bytes", "1 kB", "31.3 MB", "2 GB", "5e+03 GB",
    ]  # fmt: skip
    assert [age_words(age) for age in (-1.0, 1.0, 90.0, 7200.0, 3 * 86400.0)] == [
        "0 seconds ago", "1 second ago", "2 minutes ago", "2 hours ago", "3 days ago",
    ]  # fmt: skip


def test_the_default_is_in_the_cache_of_the_user(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("BENCH_STORE")
    assert store_folder().parts[-2:] == ("hh150-bench", "store")


def test_tests_leave_the_store_of_the_user_alone() -> None:
    assert "hh150-bench" not in store_folder().parts
