"""Files of strangers, opened with care: one may be a named pipe, a device, a folder, a loop of links, or endless."""

import os
import stat
from pathlib import Path

from bench.record.limits import Limit

KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a named pipe"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)
CHUNK = 1 << 24  # [bytes] read at a time; files of the system say of themselves that they are empty


class FileFault(Exception):  # noqa: N818  it never reaches a user: the reader makes a finding or an error of it
    """A file that is not read; the message says why."""

    def __init__(self, message: str, remedy: str) -> None:
        self.remedy = remedy
        super().__init__(message)


def read_plain(path: Path, most: Limit) -> bytes:
    """Return what stands in a file.

    Raises:
        FileFault: It is not there, not readable, no plain file, or larger than is read.
    """
    try:
        expect_plain(path, most)
        # between the look and the opening it may have become a pipe: an opening that does not wait survives that
        with os.fdopen(os.open(path, os.O_RDONLY | os.O_NONBLOCK), "rb") as file:
            content = bytearray()
            while chunk := file.read(CHUNK):
                content += chunk
                if most.exceeded(len(content)):
                    raise FileFault(f"has more than {most}", most.remedy)
            return bytes(content)
    except OSError as error:
        raise _unreadable(error) from error


def expect_plain(path: Path, most: Limit) -> int:
    """Return the size of a file [bytes].

    Raises:
        FileFault: It is not there, no plain file, or larger than is read.
    """
    try:
        found = path.stat()
    except (OSError, ValueError) as error:  # ValueError: a zero byte in the name
        raise _unreadable(error) from error
    for is_kind, word in KINDS:
        if is_kind(found.st_mode):
            raise FileFault(f"is {word}, not a file", "put a plain file there")
    if most.exceeded(found.st_size):
        size = f"{found.st_size:,}".replace(",", " ")
        raise FileFault(f"has {size} bytes, more than {most}", most.remedy)
    return found.st_size


def _unreadable(error: OSError | ValueError) -> FileFault:
    reason = getattr(error, "strerror", None) or str(error)
    return FileFault(f"cannot be read: {reason}", "put it there and make it readable")
