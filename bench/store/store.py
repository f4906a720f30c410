"""A folder of entries, each under the digest of what it was computed from.

Reading needs no lock: a file appears complete or not at all. Who writes holds a lock on the folder, which the system
releases when the process ends in any way; an unfinished file that is seen under the lock belongs to nobody any more.
"""

import fcntl
import os
import re
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from numpy.typing import NDArray

from bench.store.entry import MAGIC, Arrays, DamagedEntryError, decode, encode, head_of

LIMIT_BYTES = 2_000_000_000
PATIENCE_S = 10.0  # for which a writer waits for another one; to write an entry takes far less than a second
PAUSE_S = 0.01
HEAD_BYTES = 65536  # of a file, in which its header ends
LOCK = "lock"
KEY = re.compile(r"[0-9a-f]{32,128}")
ENTRY = re.compile(r"([0-9a-f]{32,128})\.entry")
PARTIAL = re.compile(r"[0-9a-f]{32,128}\.partial")


@dataclass(frozen=True)
class Entry:
    """A file of the store, as a list shows it.

    Attributes:
        key: Its key.
        label: For people; empty where the file is damaged.
        size: [bytes]
        made_s: When it was written, seconds since 1970; nan where the file is damaged.
        used_s: When it was written or read last.
    """

    key: str
    label: str
    size: int
    made_s: float
    used_s: float


@dataclass(frozen=True)
class Store:
    """Named arrays by key, in a folder that is made when something is put there first.

    Attributes:
        folder: Where.
        limit_bytes: What all files together never exceed; entries that were not used for longest give way.
    """

    folder: Path
    limit_bytes: int = LIMIT_BYTES

    def get(self, key: str) -> dict[str, NDArray[Any]] | None:
        """Return the arrays under a key, read-only; None where there are none.

        A file that is damaged, cut off or of another key counts as absent and is removed.
        """
        file = self._file(key)
        try:
            with _opened(file) as opened:
                start = opened.read(len(MAGIC))
                content = start + opened.read() if start == MAGIC else start
        except OSError:
            return None
        try:
            arrays = decode(content, key)
        except DamagedEntryError:
            with suppress(OSError):
                file.unlink()
            return None
        with suppress(OSError):  # in a folder that cannot be written nothing has to give way either
            os.utime(file)
        return arrays

    def put(self, key: str, arrays: Arrays, label: str = "") -> str | None:
        """Keep arrays under a key; return why that was not possible, None if it was.

        A store that cannot be written is no error: what it would have kept is computed again.

        Args:
            key: Of what they were computed from (`digest`).
            arrays: By name; of numbers.
            label: For people.

        Raises:
            TypeError: An array of anything but numbers.
        """
        file = self._file(key)
        pieces = encode(key, arrays, label, time.time())
        size = sum(memoryview(piece).nbytes for piece in pieces)
        if size > self.limit_bytes:
            return f"{size} bytes are more than the limit of the store, {self.limit_bytes}"
        partial = file.with_suffix(".partial")
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            with self.locked():
                try:
                    self._make_room(size, first=key)
                    with partial.open("wb") as opened:
                        for piece in pieces:
                            opened.write(piece)
                        opened.flush()
                        os.fsync(opened.fileno())
                    partial.replace(file)
                finally:
                    with suppress(OSError):
                        partial.unlink()
        except OSError as error:
            return f"{self.folder}: cannot be written ({error.strerror or error})"
        return None

    def known(self, prefix: str = "") -> tuple[str, ...]:
        """Return the keys that begin with something, the one that was used last first."""
        return tuple(key for _, _, key in sorted(self._files(), reverse=True) if key.startswith(prefix))

    def entries(self) -> tuple[Entry, ...]:
        """Return what is there, the entry that was used last first."""
        found = []
        for used_s, size, key in sorted(self._files(), reverse=True):
            label, made_s = "", float("nan")
            with suppress(OSError, DamagedEntryError), _opened(self._file(key)) as opened:
                head = head_of(opened.read(HEAD_BYTES))
                label, made_s = head.label, head.made_s
            found.append(Entry(key, label, size, made_s, used_s))
        return tuple(found)

    def shrink(self) -> str | None:
        """Remove what exceeds the limit, and what processes that were killed left; return why not, None if done."""
        return self._remove(everything=False)

    def clear(self) -> str | None:
        """Remove every entry; return why not, None if done. Files of other names are not touched."""
        return self._remove(everything=True)

    def _remove(self, *, everything: bool) -> str | None:
        if not self.folder.is_dir():
            return None
        try:
            with self.locked():
                self._make_room(0)
                for key in self.known() if everything else ():
                    self._file(key).unlink(missing_ok=True)
        except OSError as error:
            return f"{self.folder}: cannot be written ({error.strerror or error})"
        return None

    def _file(self, key: str) -> Path:
        if not KEY.fullmatch(key):
            raise ValueError(f"{key!r} is no key; make one with `digest`")
        return self.folder / f"{key}.entry"

    def _files(self) -> Iterator[tuple[float, int, str]]:
        """Yield when an entry was used, its size and its key."""
        try:
            with os.scandir(self.folder) as listed:
                for item in listed:
                    if match := ENTRY.fullmatch(item.name):
                        with suppress(FileNotFoundError):  # gave way meanwhile
                            about = item.stat()
                            yield about.st_mtime, about.st_size, match[1]
        except OSError:
            return

    def _make_room(self, size: int, first: str = "") -> None:
        """Remove unfinished files, then entries until `size` bytes more fit; the lock is held.

        Args:
            size: [bytes]
            first: Key of the entry that gives way before all others.
        """
        for file in self.folder.iterdir():
            if PARTIAL.fullmatch(file.name):
                file.unlink(missing_ok=True)
        known = sorted(self._files(), key=lambda entry: (entry[2] != first, entry[0]))
        total = sum(taken for _, taken, _ in known)
        for _, taken, key in known:
            if total + size <= self.limit_bytes:
                return
            self._file(key).unlink(missing_ok=True)
            total -= taken

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Hold the folder, which is there, against other writers.

        Raises:
            OSError: Not allowed, or another process does not let go.
        """
        handle = os.open(self.folder / LOCK, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            end = time.monotonic() + PATIENCE_S
            while True:
                try:
                    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    break
                except BlockingIOError:
                    if time.monotonic() > end:
                        raise
                    time.sleep(PAUSE_S)
            try:
                yield
            finally:
                fcntl.flock(handle, fcntl.LOCK_UN)  # a process that was forked meanwhile has the same handle
        finally:
            os.close(handle)


def _opened(file: Path) -> BinaryIO:
    """Open a file to read it; a named pipe in its place is not waited for, and reads as empty."""
    return os.fdopen(os.open(file, os.O_RDONLY | os.O_NONBLOCK), "rb")
