"""Independent jobs on all cores, with common progress; Ctrl-C ends them all."""

import multiprocessing
import os
import signal
from collections.abc import Callable, Sequence
from multiprocessing.queues import Queue
from queue import Empty
from typing import TypeVar

Job = TypeVar("Job")
Result = TypeVar("Result")
Progress = Callable[[float], None]

POLL = 0.1  # [s]

_report: "Queue[tuple[int, float]] | None" = None  # of a worker: where its progress goes


def run_all(work: Callable[[Job, Progress], Result], jobs: Sequence[Job], progress: Progress) -> list[Result]:
    """Run `work(job, progress)` for every job, one process a core, and return the results in order.

    Args:
        work: A function of a module; it runs in another process.
        jobs: Its arguments; they are pickled.
        progress: Called with the mean share of all jobs that is done, 0 to 1.

    Raises:
        Exception: Whatever the first failing job raised.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # of the workers: there is one for each core already
    context = multiprocessing.get_context("spawn")
    queue: Queue[tuple[int, float]] = context.Queue()
    done = [0.0] * len(jobs)
    with context.Pool(min(len(jobs), os.cpu_count() or 1), _start_worker, (queue,)) as pool:
        pending = pool.map_async(_call, [(work, index, job) for index, job in enumerate(jobs)], chunksize=1)
        while not pending.ready():
            try:
                index, share = queue.get(timeout=POLL)
            except Empty:
                continue
            done[index] = share
            progress(sum(done) / len(jobs))
        results: list[Result] = pending.get()
    return results


def _start_worker(queue: "Queue[tuple[int, float]]") -> None:
    global _report
    _report = queue
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides


def _call(task: tuple[Callable[[Job, Progress], Result], int, Job]) -> Result:
    work, index, job = task

    def report(share: float) -> None:
        if _report is not None:
            _report.put((index, share))

    return work(job, report)
