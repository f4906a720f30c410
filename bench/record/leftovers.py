"""What processes leave behind that were killed: folders half filled, which the next run in the same place removes.

A process locks the folder that it fills (flock), and the system unlocks it when the process ends, however it ends. So a
folder with the name of a half-filled one, and without a lock, belongs to nobody.
"""

import contextlib
import fcntl
import os
import re
import secrets
from collections.abc import Iterator
from pathlib import Path

PARTIAL = re.compile(r"\.(?P<name>[^/]+)\.[0-9a-f]{8}\.(?P<kind>partial|old)")


_locked: set[int] = set()  # descriptors of this process


def _forget() -> None:
    """Close them in a process that was forked: a worker that outlives its caller would keep the caller's locks."""
    for opened in _locked:
        os.close(opened)
    _locked.clear()


os.register_at_fork(after_in_child=_forget)


class Held:
    """A folder that is locked as long as this object is not let go.

    Attributes:
        is_sure: Whether nobody else has it; False where the disk knows no locks, or somebody has it.
        is_taken: Whether somebody else has it.
    """

    def __init__(self, folder: Path) -> None:
        self.is_sure = self.is_taken = False
        self._opened = -1
        with contextlib.suppress(OSError):
            self._opened = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC | os.O_NOFOLLOW)
            _locked.add(self._opened)
            try:
                fcntl.flock(self._opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
                # meanwhile somebody may have removed it and another may have its name
                self.is_sure = os.path.samestat(os.fstat(self._opened), folder.lstat())
            except BlockingIOError:
                self.is_taken = True

    def let_go(self) -> None:
        """Unlock it."""
        if self._opened >= 0:
            _locked.discard(self._opened)
            os.close(self._opened)
            self._opened = -1


def partial_names(folder: Path) -> tuple[Path, Path]:
    """Return the names beside a folder of one that is being filled, and of the one that it replaces."""
    token = secrets.token_hex(4)
    return folder.with_name(f".{folder.name}.{token}.partial"), folder.with_name(f".{folder.name}.{token}.old")


@contextlib.contextmanager
def to_fill(folder: Path) -> Iterator[tuple[Path, Path]]:
    """Make and lock a folder to fill; give it and the name for the one that it replaces; remove both in the end.

    A signal may end the process at any time: names are known before anything has them.
    """
    while True:
        partial, old = partial_names(folder)
        locks = contextlib.ExitStack()
        try:
            partial.mkdir()
            held = Held(partial)
            locks.callback(held.let_go)
            if held.is_sure or (partial.is_dir() and not held.is_taken):  # the latter on a disk that knows no locks
                replaced = Held(folder)  # until the new one has its name; nobody takes it for a leftover meanwhile
                locks.callback(replaced.let_go)
                yield partial, old
                return
            # one that cleans up was faster
        finally:
            if old.exists() and not folder.exists():
                old.rename(folder)
            for leftover in (partial, old):
                remove(leftover)
            locks.close()


def remove(folder: Path) -> None:
    """Remove a folder with all that is in it, as far as that is allowed; with one open file at a time.

    `shutil.rmtree` needs one for each level, which a process that has run out of them does not get.
    """
    for place, folders, files in os.walk(folder, topdown=False):
        for name in (*files, *folders):
            path = Path(place, name)
            with contextlib.suppress(OSError):
                if path.is_dir() and not path.is_symlink():
                    path.rmdir()
                else:
                    path.unlink()
    with contextlib.suppress(OSError):
        folder.rmdir()


class Reserve:
    """An open file that is kept to be closed when another is needed, where no more than so many may be open."""

    def __init__(self) -> None:
        self._opened = -1
        with contextlib.suppress(OSError):
            self._opened = os.open(os.devnull, os.O_RDONLY | os.O_CLOEXEC)

    def let_go(self) -> None:
        """Close it."""
        if self._opened >= 0:
            os.close(self._opened)
            self._opened = -1


def remove_leftovers(place: Path) -> None:
    """Remove what dead processes left in a folder; a folder that one was just replacing gets its name back."""
    for entry in _partials(place):
        held = Held(entry)
        named = PARTIAL.fullmatch(entry.name)
        if held.is_sure and named:
            with contextlib.suppress(OSError):
                original = entry.with_name(named["name"])
                if named["kind"] == "old" and not original.exists():
                    entry.rename(original)
                else:
                    remove(entry)
        held.let_go()


def _partials(place: Path) -> Iterator[Path]:
    try:
        entries = sorted(place.iterdir())
    except OSError:
        return
    yield from (entry for entry in entries if PARTIAL.fullmatch(entry.name) and not entry.is_symlink())
