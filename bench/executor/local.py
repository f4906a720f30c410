"""The executor for this machine."""

import os

from bench.executor.contract import Executor
from bench.executor.processes import DEFAULT, Processes, Start
from bench.executor.serial import SERIAL


def on_cores(cores: int = 0, start: Start = DEFAULT) -> Executor:
    """Return what works on some cores of this machine.

    Args:
        cores: How many; 0: all.
        start: How processes start, as in `Processes`.
    """
    count = cores or os.cpu_count() or 1
    return SERIAL if count == 1 else Processes(count, start)
