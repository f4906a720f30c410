"""Work that is tried on every executor; in a module, so that workers that are not forked find it."""

import os
import signal
import time
from pathlib import Path

from bench.errors import InputError
from bench.executor.contract import POLL, Progress
from bench.executor.local import on_cores

ENOUGH = "enough"


def square(item: int, progress: Progress) -> int:
    return item * item


def who(item: object, progress: Progress) -> int:
    return os.getpid()


def fails_at_two(item: int, progress: Progress) -> int:
    if item == 2:
        raise InputError(["two is bad", "worse than one"])
    return item


def fails_oddly(item: int, progress: Progress) -> int:
    class OddError(Exception):
        """Cannot be pickled."""

    raise OddError(f"item {item}")


def halfway(item: int, progress: Progress) -> int:
    progress(0.5)
    time.sleep(3 * POLL)
    return item


def nested(item: int, progress: Progress) -> list[int]:
    executor = on_cores(2)
    return [done.value for done in executor.map(who, range(3))] + [os.getpid()]


def dies(item: int, progress: Progress) -> int:
    if item == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return item


def sleeps(folder: Path, progress: Progress) -> None:
    """Work until somebody says that it is enough."""
    (folder / str(os.getpid())).touch()
    while not (folder / ENOUGH).exists():
        time.sleep(POLL)
