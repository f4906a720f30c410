"""What killed processes leave behind is removed by the next run; what living ones fill is not touched."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from bench.errors import InputError
from bench.record import leftovers
from bench.record.folder import new_folder
from bench.record.leftovers import remove_leftovers

FILLS = """
import os, signal, sys, time
from pathlib import Path
from bench.record.folder import new_folder
with new_folder(Path(sys.argv[1]), "mark", replace=False) as partial:
    (partial / "mark").touch()
    {then}
"""
DIES = "os.kill(os.getpid(), signal.SIGKILL)"
WAITS = "print('fills', flush=True); sys.stdin.read()"


def filling(folder: Path, then: str) -> "subprocess.Popen[str]":
    code = FILLS.format(then=then)
    pipe = subprocess.PIPE
    return subprocess.Popen([sys.executable, "-c", code, str(folder)], stdin=pipe, stdout=pipe, text=True)


def partials(place: Path) -> list[str]:
    return sorted(entry.name for entry in place.iterdir() if entry.name.startswith("."))


def another_run(place: Path) -> None:
    with new_folder(place / "another", "mark", replace=True) as partial:
        (partial / "mark").touch()


def test_leftovers_of_the_dead_are_removed_by_the_next_run(tmp_path: Path) -> None:
    with filling(tmp_path / "out", DIES) as dies:
        assert dies.wait() == -signal.SIGKILL
    assert len(partials(tmp_path)) == 1
    another_run(tmp_path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["another"]


RUNS_OUT = """
    (partial / "deep" / "er").mkdir(parents=True)
    (partial / "deep" / "er" / "file").touch()
    (partial / "link").symlink_to("deep")
    import resource
    resource.setrlimit(resource.RLIMIT_NOFILE, (16, 16))
    every = []
    while True:
        every.append(os.open(os.devnull, os.O_RDONLY))
"""


def test_nothing_is_left_where_no_more_files_may_be_open(tmp_path: Path) -> None:
    with filling(tmp_path / "out", RUNS_OUT) as dies:
        assert dies.wait() == 1
    assert not list(tmp_path.iterdir())


def test_folders_of_the_living_are_not_touched(tmp_path: Path) -> None:
    with filling(tmp_path / "out", WAITS) as lives:
        assert lives.stdout
        assert lives.stdout.readline() == "fills\n"
        before = partials(tmp_path)
        another_run(tmp_path)
        assert partials(tmp_path) == before
        assert len(before) == 1
        lives.communicate("")
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["another", "out"]
    assert (tmp_path / "out" / "mark").exists()


def test_a_worker_that_outlives_its_caller_keeps_no_lock(tmp_path: Path) -> None:
    code = "if os.fork() == 0: print(os.getpid(), flush=True)\n    time.sleep(60)"
    with filling(tmp_path / "out", code) as dies:
        assert dies.stdout
        child = int(dies.stdout.readline())
        dies.kill()
        dies.wait()
        another_run(tmp_path)
        os.kill(child, signal.SIGKILL)
    assert partials(tmp_path) == []


def test_a_folder_that_was_just_replaced_gets_its_name_back(tmp_path: Path) -> None:
    (tmp_path / ".out.0123abcd.old").mkdir()
    (tmp_path / ".out.0123abcd.old" / "mark").touch()
    (tmp_path / ".out.0123abcd.partial").mkdir()
    remove_leftovers(tmp_path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["out"]
    assert (tmp_path / "out" / "mark").exists()


def test_other_things_stay(tmp_path: Path) -> None:
    (tmp_path / ".out.0123abcd.partial").touch()
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / ".link.0123abcd.partial").symlink_to(tmp_path / "elsewhere")
    (tmp_path / ".mine.partial").mkdir()
    before = sorted(tmp_path.iterdir())
    remove_leftovers(tmp_path)
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("word", ["file/sub", "loop", "loop/sub"])
def test_places_that_cannot_be(word: str, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "loop").symlink_to("loop")
    with pytest.raises(InputError, match=r"is a (file|loop of links)"), new_folder(tmp_path / word, "mark", False):
        pass


@pytest.mark.parametrize("locked", [0, 1])
def test_a_signal_while_a_folder_is_made_leaves_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, locked: int
) -> None:
    """SIGTERM came between the folder and its lock, and the folder stayed."""
    held: list[Path] = []
    lock = leftovers.Held

    def told_to_end(folder: Path) -> leftovers.Held:
        held.append(folder)
        if len(held) > locked:
            raise KeyboardInterrupt
        return lock(folder)

    monkeypatch.setattr(leftovers, "Held", told_to_end)
    with pytest.raises(KeyboardInterrupt), new_folder(tmp_path / "out", "mark", replace=False):
        pass
    assert partials(tmp_path) == []
