"""The store with several processes, with processes that are killed, and with a disk that cannot be written."""

import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from bench.store.digest import digest
from bench.store.store import Store

KEY = digest("one")
NOBODY = 65534
LIMIT = 3_000_000
STARTED_S = 60.0  # within which a process is under way on a busy machine
HEAD = """
import os, signal, sys
from pathlib import Path
import numpy as np
from bench.store import store as stores
from bench.store.digest import digest
from bench.store.store import Store
store = Store(Path(sys.argv[1]), int(sys.argv[2]))
"""
# Every process puts its own keys and keys that all share, and reads what others put.
BUSY = """
me = int(sys.argv[3])
for i in range(40):
    for key, value in ((digest(me, i), me), (digest("shared", i % 5), 7)):
        assert store.put(key, {"x": np.full(5000, value, float)}) is None
        total = sum(size for _, size, _ in store._files())
        assert total <= store.limit_bytes, total
    for key in store.known()[:10]:
        found = store.get(key)
        assert found is None or len(set(found["x"].tolist())) == 1
"""
# Dies by kill -9 when a certain part of the file is written, with the lock in its hand.
KILLED = """
class Deadly:
    def __init__(self, opened):
        self.opened = opened
    def __enter__(self):
        return self
    def __exit__(self, *about):
        self.opened.close()
    def write(self, piece):
        self.opened.write(piece)
        self.opened.flush()
        left[0] -= 1
        if left[0] < 0:
            os.kill(os.getpid(), signal.SIGKILL)
    def flush(self):
        self.opened.flush()
    def fileno(self):
        return self.opened.fileno()
left = [int(sys.argv[3])]
path_open = Path.open
Path.open = lambda self, mode: Deadly(path_open(self, mode)) if mode == "wb" else path_open(self, mode)
store.put(digest("one"), {"x": np.arange(5000.0)})
"""
# Stops in the middle of its work, holding the lock, and says so.
SLOW = """
def fsync(handle):
    print("writing", flush=True)
    sys.stdin.readline()
stores.os.fsync = fsync
why = store.put(digest("one"), {"x": np.arange(5000.0)})
print("refused" if why else "kept", flush=True)
"""


def started(code: str, folder: Path, *more: object) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-c", HEAD + code, str(folder), str(LIMIT), *map(str, more)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def test_processes_do_not_disturb_each_other(tmp_path: Path) -> None:
    workers = [started(BUSY, tmp_path, me) for me in range(3)]
    assert [worker.wait() for worker in workers] == [0, 0, 0]
    for worker in workers:
        worker.communicate()
    store = Store(tmp_path, LIMIT)
    assert store.get(digest("shared", 4)) is not None
    assert all(store.get(key) is not None for key in store.known())
    assert not list(tmp_path.glob("*.partial"))


@pytest.mark.parametrize("pieces", range(6))
def test_kill_leaves_nothing_that_is_believed(tmp_path: Path, pieces: int) -> None:
    process = started(KILLED, tmp_path, pieces)
    process.communicate()
    killed = process.returncode == -signal.SIGKILL
    assert killed == (pieces < 5)  # an entry with one dense array is written in five pieces
    store = Store(tmp_path, LIMIT)
    assert (store.get(KEY) is None) == killed
    assert bool(list(tmp_path.glob("*.partial"))) == killed
    assert store.put(digest("next"), {"x": np.ones(3)}) is None  # nobody holds the lock any more
    assert not list(tmp_path.glob("*.partial"))


def test_what_a_living_process_writes_is_left_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bench.store.store.PATIENCE_S", 0.05)
    process = started(SLOW, tmp_path)
    assert process.stdout
    assert process.stdout.readline() == "writing\n"
    store = Store(tmp_path, LIMIT)
    assert store.get(KEY) is None
    why = store.put(digest("other"), {"x": np.ones(3)})
    assert why is not None
    assert "cannot be written" in why
    assert store.clear() is not None
    assert len(list(tmp_path.glob("*.partial"))) == 1
    said, _ = process.communicate("go on\n", timeout=STARTED_S)
    assert said == "kept\n"
    assert store.get(KEY) is not None


@contextmanager
def without_rights() -> Iterator[Path]:
    """Yield a folder in which this process may read and not write; root becomes nobody for as long."""
    folder = Path(tempfile.mkdtemp())
    Store(folder).put(KEY, {"x": np.arange(3.0)})
    folder.chmod(0o555)
    is_root = os.geteuid() == 0
    if is_root:
        os.seteuid(NOBODY)
    try:
        yield folder
    finally:
        if is_root:
            os.seteuid(0)
        folder.chmod(0o700)
        shutil.rmtree(folder)


def test_a_read_only_folder_can_be_read() -> None:
    with without_rights() as folder:
        store = Store(folder)
        assert store.get(KEY) is not None
        why = store.put(digest("other"), {"x": np.ones(3)})
        assert why is not None
        assert "cannot be written" in why
        assert store.clear() is not None
        assert store.get(KEY) is not None


def test_a_full_disk_is_no_error(tmp_path: Path) -> None:
    """A limit on the size of files ends a write in the middle, as a full disk does."""
    store = Store(tmp_path)
    assert store.put(KEY, {"x": np.arange(3.0)}) is None
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, before[1]))
    try:
        why = store.put(digest("large"), {"x": np.arange(5000.0)})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, ignored)
    assert why is not None
    assert "cannot be written" in why
    assert store.known() == (KEY,)
    assert not list(tmp_path.glob("*.partial"))
