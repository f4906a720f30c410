"""Files that appear whole or not at all."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bench.errors import InputError
from bench.record.folder import UNWRITABLE


def refuse_to_overwrite(path: Path) -> None:
    """Refuse a file to write that is there already, or a folder; before the work that would be lost.

    Raises:
        InputError: It is.
    """
    if os.path.lexists(path):  # a name may be too long for pathlib
        raise InputError(f"{path}: is there already; name a file that is not.")


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a name beside `path` to write to; afterwards the file has the name `path`, after an error it is gone.

    Raises:
        InputError: The folder of `path` does not exist, nothing can be written there, or the disk is full.
    """
    partial = path.with_name(f".{path.stem}.partial{path.suffix}")
    try:
        partial.touch()
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}; choose another folder.") from error
    try:
        yield partial
        partial.replace(path)
    except OSError as error:
        if error.errno not in UNWRITABLE:
            raise
        message = f"{path}: cannot be written ({error.strerror}); free some space or choose another"
        raise InputError(message) from error
    finally:
        partial.unlink(missing_ok=True)
