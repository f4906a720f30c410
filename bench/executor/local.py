"""The executor for this machine."""

import os

from bench.executor.contract import Executor
from bench.executor.processes import Processes
from bench.executor.serial import SERIAL


def on_cores(cores: int = 0) -> Executor:
    """Return what works on some cores of this machine; 0: on all of them."""
    count = cores or os.cpu_count() or 1
    return SERIAL if count == 1 else Processes(count)
