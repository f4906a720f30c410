"""Folders that appear complete or not at all."""

import errno
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bench.errors import InputError
from bench.record.leftovers import Reserve, remove_leftovers, to_fill

UNWRITABLE = (
    *(errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO),  # full or broken
    *(errno.EACCES, errno.EPERM, errno.EROFS, errno.ENOTDIR, errno.ENAMETOOLONG, errno.ELOOP),  # not allowed here
)


@contextmanager
def new_folder(folder: Path, mark: str, replace: bool) -> Iterator[Path]:
    """Give an empty folder to fill, and move it to `folder` when the block ends without an exception.

    It stands beside its destination until then, and is removed if the block fails, also by Ctrl-C. What a process that
    was killed has left there is removed first.

    Args:
        folder: Where it shall be. May exist if it is empty.
        mark: A file that tells a folder of the same kind. Only a folder that holds it is ever replaced.
        replace: Whether to replace a folder that is not empty.

    Raises:
        InputError: `folder` is a file, or not empty and not to be replaced; or the disk is full, or not to be written.
    """
    try:
        with _new_folder(folder, mark, replace) as partial:
            yield partial
    except OSError as error:
        is_gone = error.errno == errno.ENOENT and ".partial" in str(error.filename)  # as in /proc, or taken away
        if error.errno not in UNWRITABLE and not is_gone:
            raise
        seen = re.sub(r"\.([^/]+)\.[0-9a-f]{8}\.partial", r"\1", str(folder))  # inside of one that is being filled
        message = f"{seen}: cannot be written ({error.strerror}); free some space or choose another"
        raise InputError(message) from error


@contextmanager
def _new_folder(folder: Path, mark: str, replace: bool) -> Iterator[Path]:
    folder = Path(os.path.realpath(folder))
    for place in (folder, *folder.parents):
        if place.is_symlink():  # and yet unresolved
            raise InputError(f"{folder}: {place} is a loop of links; choose another folder")
        if place.exists() and not place.is_dir():
            raise InputError(f"{folder}: {place} is a file; choose another folder")
    folder.parent.mkdir(parents=True, exist_ok=True)
    remove_leftovers(folder.parent)
    if folder.exists() and any(folder.iterdir()):
        if not replace:
            raise InputError(f"{folder}: is not empty; choose another name")
        if not (folder / mark).is_file():
            raise InputError(f"{folder}: holds other things than {mark} and is not replaced; choose another name")
    reserve = Reserve()
    with to_fill(folder) as (partial, old):
        try:
            yield partial
        finally:
            reserve.let_go()
        if replace and folder.exists():
            folder.rename(old)
        with _first_to_fill(folder):
            if folder.exists():
                folder.rmdir()
            partial.rename(folder)


@contextmanager
def _first_to_fill(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
            raise
        raise InputError(f"{folder}: was filled by somebody else meanwhile; choose another name") from error
