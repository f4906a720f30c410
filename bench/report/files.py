"""Files that appear whole or not at all."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bench.errors import InputError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a name beside `path` to write to; afterwards the file has the name `path`, after an error it is gone.

    Raises:
        InputError: The folder of `path` does not exist, or nothing can be written there.
    """
    partial = path.with_name(f".{path.stem}.partial{path.suffix}")
    try:
        partial.touch()
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}; choose another folder.") from error
    try:
        yield partial
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)
