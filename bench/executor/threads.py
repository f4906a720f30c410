"""Side by side in threads of this process, for work that lets go of the interpreter's lock."""

from collections.abc import Generator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextvars import copy_context
from dataclasses import dataclass
from functools import partial
from queue import Empty, SimpleQueue

from bench.executor.contract import POLL, Done, Item, Progress, Result, Work, become_worker, ignore, inside_worker
from bench.executor.serial import SERIAL


@dataclass(frozen=True)
class Threads:
    """Does as many items at a time as there are threads; a thread that is told to end finishes its item.

    Attributes:
        cores: Threads.
    """

    cores: int

    @property
    def shares_memory(self) -> bool:
        """There is one memory: work must not change what other work reads."""
        return True

    def map(
        self, work: Work[Item, Result], items: Sequence[Item], progress: Progress = ignore
    ) -> Generator[Done[Result], None, None]:
        """Yield what some work makes of every item; see `Executor.map`."""
        count = min(self.cores, len(items))
        if inside_worker() or count < 2:
            yield from SERIAL.map(work, items, progress)
            return
        shares = [0.0] * len(items)
        finished: SimpleQueue[Future[Result]] = SimpleQueue()
        progress(0.0)
        with ThreadPoolExecutor(count) as pool:
            try:
                index_of = {}
                for index, item in enumerate(items):
                    # each in a copy of the caller's context: NumPy keeps there what floating-point errors do
                    future = pool.submit(copy_context().run, _worked, work, item, partial(shares.__setitem__, index))
                    index_of[future] = index
                    future.add_done_callback(finished.put)
                while index_of:
                    try:
                        future = finished.get(timeout=POLL)
                    except Empty:
                        progress(sum(shares) / len(items))
                        continue
                    index = index_of.pop(future)
                    shares[index] = 1.0
                    yield Done(index, future.result())
                    progress(sum(shares) / len(items))
            finally:
                pool.shutdown(wait=False, cancel_futures=True)


def _worked(work: Work[Item, Result], item: Item, progress: Progress) -> Result:
    become_worker()
    return work(item, progress)
