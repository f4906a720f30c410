"""The executor for this machine."""

import os

from bench.errors import InputError
from bench.executor.contract import Executor
from bench.executor.processes import CAN_FORK, Processes, Start
from bench.executor.serial import SERIAL
from bench.executor.threads import Threads


def on_cores(cores: int = 0, start: Start = "fork") -> Executor:
    """Return what works on some cores of this machine: threads where processes cannot be forked.

    Args:
        cores: How many; 0: all.
        start: "spawn" for work that is plain data and does not bear to be forked, as in `Processes`.

    Raises:
        InputError: Less than none.
    """
    if cores < 0:
        raise InputError(f"--cores {cores}: give how many cores to use, or 0 for all.")
    count = cores or os.cpu_count() or 1
    if count == 1:
        return SERIAL
    return Processes(count, start) if start == "spawn" or CAN_FORK else Threads(count)
