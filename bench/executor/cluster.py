"""On the workers of a Dask scheduler, on this machine or on many.

What a worker that died had under way is given to another one, so no result is lost, and none comes twice.
"""

from collections.abc import Generator, Sequence
from contextvars import copy_context
from functools import partial
from time import sleep
from types import TracebackType
from typing import TYPE_CHECKING

from threadpoolctl import threadpool_limits

from bench.errors import BenchError, InputError
from bench.executor.contract import POLL, Done, Item, Progress, Result, Work, become_worker, ignore, inside_worker
from bench.executor.serial import SERIAL

if TYPE_CHECKING:
    from distributed import Future

PATIENCE_S = 10.0  # for a scheduler to answer
EXTRA = "python -m pip install 'hh150-bench[cluster]'"


class ClusterError(BenchError):
    """The scheduler is gone, or its workers die of the work."""


class Cluster:
    """Does as many items at a time as the scheduler has workers; work, items and results are pickled.

    A worker may come and go at any time. How much is done of an item that is under way is not told.

    Args:
        address: Of the scheduler, such as "tcp://10.0.0.1:8786".

    Raises:
        InputError: No scheduler answers there, or Dask is not installed.
    """

    def __init__(self, address: str) -> None:
        try:
            from distributed import Client
        except ImportError as error:
            raise InputError(f"a scheduler needs dask.distributed: {EXTRA}") from error
        try:
            self._client: Client = Client(address, timeout=PATIENCE_S, set_as_default=False)
        except (OSError, ValueError) as error:
            raise InputError(f"{address}: no scheduler answers ({error}); start one with `dask scheduler`.") from error
        self.address = address

    def __enter__(self) -> "Cluster":
        """Return itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, _: BaseException | None, __: TracebackType | None) -> None:
        """Leave the scheduler."""
        self._client.close()

    @property
    def shares_memory(self) -> bool:
        """Workers have a memory of their own."""
        return False

    def map(
        self, work: Work[Item, Result], items: Sequence[Item], progress: Progress = ignore
    ) -> Generator[Done[Result], None, None]:
        """Yield what some work makes of every item; see `Executor.map`.

        Raises:
            InputError: A worker has several threads: what work remembers of a process is for one.
            ClusterError: The connection to the scheduler broke for good, or an item killed several workers.
        """
        from distributed import as_completed

        if inside_worker() or not items:
            yield from SERIAL.map(work, items, progress)
            return
        futures = self._client.map(partial(_called, work), items, pure=False)
        index_of = {future.key: index for index, future in enumerate(futures)}
        progress(0.0)
        try:
            coming = as_completed(futures, loop=self._client.loop)
            while index_of:
                if coming.is_empty() or not coming.has_ready():
                    self._expect_scheduler()
                    sleep(POLL)
                    progress(1 - len(index_of) / len(items))
                    continue
                future = next(coming)
                index = index_of.pop(future.key)
                yield Done(index, self._value_of(future))
                future.release()
                progress(1 - len(index_of) / len(items))
        finally:
            if index_of:
                self._client.cancel(futures, force=True)

    def _expect_scheduler(self) -> None:
        if self._client.status not in ("running", "connecting"):
            raise ClusterError(f"{self.address}: the connection to the scheduler broke; what is done is kept.")

    def _value_of(self, future: "Future[Result]") -> Result:
        from distributed import CancelledError, KilledWorker

        try:
            value: Result = future.result()
        except CancelledError as error:
            raise ClusterError(f"{self.address}: the scheduler lost what was under way ({error}).") from error
        except KilledWorker as error:
            raise ClusterError(f"{self.address}: workers die of one and the same piece of work ({error}).") from error
        return value


def _called(work: Work[Item, Result], item: Item) -> Result:
    from distributed import get_worker

    worker = get_worker()
    if worker.state.nthreads != 1:
        raise InputError(f"{worker.address}: this worker has several threads; start workers with --nthreads 1.")
    with threadpool_limits(1, "blas"):
        return copy_context().run(_worked, work, item)


def _worked(work: Work[Item, Result], item: Item) -> Result:
    become_worker()
    return work(item, ignore)
