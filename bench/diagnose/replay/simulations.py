"""Many worlds, simulated on all cores."""

import multiprocessing
import os
import signal
from collections.abc import Callable, Sequence

from bench.diagnose.replay.replay import Replay, World
from bench.errors import BenchError
from bench.record.campaign import Array

Progress = Callable[[float], None]
FEW = 8  # worlds that are not worth a second process

_shared: tuple[Replay, Sequence[World]] | None = None  # of a worker, from the moment it is forked


def simulate_all(
    replay: Replay, worlds: Sequence[World], progress: Progress = lambda share: None, cores: int | None = None
) -> list[Array | BenchError]:
    """Return what instruments show in every world, each shape (T, c), or why a world could not be simulated.

    Args:
        replay: The campaign.
        worlds: Hypotheses.
        progress: Called with the share that is done.
        cores: Processes to use; None: one for each core. Workers are forked, for effects may come from a user's file.
    """
    global _shared
    cores = cores or int(os.environ.get("BENCH_CORES", 0)) or os.cpu_count() or 1
    if cores == 1 or len(worlds) < FEW or "fork" not in multiprocessing.get_all_start_methods():
        results = []
        for i, world in enumerate(worlds):
            results.append(_predict(replay, world))
            progress((i + 1) / len(worlds))
        return results
    _shared = (replay, worlds)
    try:
        with multiprocessing.get_context("fork").Pool(cores, _start_worker) as pool:
            found = []
            for i, result in enumerate(pool.imap(_simulate, range(len(worlds)), chunksize=4)):
                found.append(result)
                progress((i + 1) / len(worlds))
    finally:
        _shared = None
    return found


def _start_worker() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides


def _simulate(index: int) -> Array | BenchError:
    assert _shared
    replay, worlds = _shared
    return _predict(replay, worlds[index])


def _predict(replay: Replay, world: World) -> Array | BenchError:
    try:
        return replay.predict(world)
    except BenchError as error:
        return error
