"""Many worlds, or many fits, on all cores."""

import multiprocessing
import os
import signal
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from bench.diagnose.replay.replay import Replay, World
from bench.errors import BenchError
from bench.record.campaign import Array

Progress = Callable[[float], None]
Item = TypeVar("Item")
Result = TypeVar("Result")
FEW = 8  # worlds that are not worth a second process

_shared: tuple[Callable[[Any], Any], Sequence[Any]] | None = None  # of a worker, from the moment it is forked


def simulate_all(
    replay: Replay, worlds: Sequence[World], progress: Progress = lambda share: None
) -> list[Array | BenchError]:
    """Return what instruments show in every world, each shape (T, c), or why a world could not be simulated.

    Args:
        replay: The campaign.
        worlds: Hypotheses.
        progress: Called with the share that is done.
    """

    def predict(world: World) -> Array | BenchError:
        try:
            return replay.predict(world)
        except BenchError as error:
            return error

    return on_all_cores(predict, worlds, progress, few=FEW, at_a_time=4)


def on_all_cores(
    work: Callable[[Item], Result],
    items: Sequence[Item],
    progress: Progress = lambda share: None,
    few: int = 2,
    at_a_time: int = 1,
) -> list[Result]:
    """Return what some work makes of every item, in order; what it raises is raised.

    Workers are forked, for effects may come from a user's file: work and items need not be pickled, results must be.
    `BENCH_CORES` in the environment limits the processes.

    Args:
        work: To be done.
        items: On what.
        progress: Called with the share that is done.
        few: Items that are not worth a second process are less.
        at_a_time: Items that a process takes at a time.
    """
    global _shared
    cores = int(os.environ.get("BENCH_CORES", 0)) or os.cpu_count() or 1
    if cores == 1 or len(items) < few or "fork" not in multiprocessing.get_all_start_methods():
        results = []
        for i, item in enumerate(items):
            results.append(work(item))
            progress((i + 1) / len(items))
        return results
    _shared = (work, items)
    try:
        with multiprocessing.get_context("fork").Pool(cores, _start_worker) as pool:
            found = []
            for i, result in enumerate(pool.imap(_worked, range(len(items)), chunksize=at_a_time)):
                found.append(result)
                progress((i + 1) / len(items))
    finally:
        _shared = None
    return found


def _start_worker() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides


def _worked(index: int) -> Any:
    assert _shared
    work, items = _shared
    return work(items[index])
