"""Side by side in processes of this machine.

Where processes can be forked, workers have the work and its items from the caller's memory, and only results are
pickled; effects from a user's own file need that. Where they cannot be, everything is pickled. Workers hear nothing of
Ctrl-C and SIGTERM: the caller does, and ends them.
"""

import multiprocessing
import os
import pickle
import signal
import sys
import traceback
from collections import deque
from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import connection, resource_tracker
from multiprocessing.process import BaseProcess
from types import TracebackType
from typing import Any, Literal

from threadpoolctl import threadpool_limits

from bench.errors import BenchError
from bench.executor.contract import POLL, Done, Item, Progress, Result, Work, become_worker, ignore, inside_worker
from bench.executor.serial import SERIAL

Start = Literal["fork", "spawn"]
Pipe = Any  # multiprocessing.connection.Connection, or PipeConnection where pipes are those of Windows

# macOS can fork, but its own libraries do not bear it
CAN_FORK = "fork" in multiprocessing.get_all_start_methods() and sys.platform != "darwin"
DEFAULT: Start = "fork" if CAN_FORK else "spawn"
WORTH_TELLING = 0.005  # share of an item by which it has to advance before it is told again


class WorkerLostError(BenchError):
    """A worker process ended though nobody asked it to."""


@dataclass(frozen=True)
class Processes:
    """Does as many items at a time as there are processes; they live as long as one `map` does.

    Attributes:
        cores: Processes.
        start: "fork", or "spawn" for work in libraries that have threads of their own and do not bear to be forked.
    """

    cores: int
    start: Start = DEFAULT

    @property
    def shares_memory(self) -> bool:
        """Whether workers are forked."""
        return self.start == "fork"

    def map(
        self, work: Work[Item, Result], items: Sequence[Item], progress: Progress = ignore
    ) -> Generator[Done[Result], None, None]:
        """Yield what some work makes of every item; see `Executor.map`.

        Raises:
            WorkerLostError: A process was killed, as for lack of memory.
        """
        count = min(self.cores, len(items))
        if inside_worker() or count < 2:
            yield from SERIAL.map(work, items, progress)
            return
        waiting = deque(range(len(items)))
        shares = [0.0] * len(items)
        left = len(items)
        progress(0.0)
        with _crew(self.start, count, work, items) as crew:
            for pipe in crew:
                pipe.send(waiting.popleft())
            while left:
                ready: list[Pipe] = connection.wait(list(crew), timeout=POLL)
                for pipe in ready:
                    told = _heard(pipe, crew)
                    if isinstance(told, _Share):
                        shares[told.index] = told.share
                        continue
                    if waiting:
                        pipe.send(waiting.popleft())
                    if isinstance(told, _Failed):
                        raise told.error
                    shares[told.index] = 1.0
                    left -= 1
                    yield told
                progress(1.0 if not left else sum(shares) / len(items))


@dataclass(frozen=True)
class _Share:
    """How much of an item is done."""

    index: int
    share: float


@dataclass(frozen=True)
class _Failed:
    """What an item ended in."""

    error: Exception


@contextmanager
def _crew(start: Start, count: int, work: Any, items: Sequence[Any]) -> Iterator[dict[Pipe, BaseProcess]]:
    """Give processes by the pipe to each; at the end of the block there are none, whatever they are doing."""
    context: Any = multiprocessing.get_context(start)
    crew: dict[Pipe, BaseProcess] = {}
    try:
        with _deaf(start):
            for _ in range(count):
                own, theirs = context.Pipe()
                # a worker that kept the other ends would not notice that its caller is gone
                kept = (*crew, own) if start == "fork" else ()
                process = context.Process(target=_serve, args=(work, items, theirs, kept), daemon=True)
                crew[own] = process
                process.start()
                theirs.close()
        yield crew
    finally:
        started = [process for process in crew.values() if process.pid is not None]
        for process in started:
            process.kill()
        for process in started:
            process.join()
            process.close()
        for pipe in crew:
            pipe.close()


@contextmanager
def _deaf(start: Start) -> Iterator[None]:
    """Start processes that hear no Ctrl-C, SIGTERM or SIGHUP from their first moment on; the caller hears it later."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    if start == "spawn":
        resource_tracker.ensure_running()  # it would let the signal through again when it starts
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM, signal.SIGHUP})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _heard(pipe: Pipe, crew: dict[Pipe, BaseProcess]) -> Any:
    try:
        return pipe.recv()
    except (EOFError, ConnectionResetError) as error:
        process = crew[pipe]
        process.join()
        raise WorkerLostError(
            f"a worker process ended before its work was done (exit code {process.exitcode}; -9 is often a lack of "
            "memory); try again with fewer --cores."
        ) from error


def _serve(work: Any, items: Sequence[Any], pipe: Pipe, kept: tuple[Pipe, ...]) -> None:
    """Work on the items whose indices come through the pipe, until nobody is at its other end."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_IGN)  # as of Ctrl-C: a scheduler sends it to the whole group
    if hasattr(signal, "SIGHUP"):
        signal.signal(signal.SIGHUP, signal.SIG_IGN)
    become_worker()
    for other in kept:
        other.close()
    with threadpool_limits(1, "blas"), suppress(EOFError, BrokenPipeError, ConnectionResetError):
        while True:
            index = pipe.recv()
            with _Answer(pipe):
                pipe.send(Done(index, work(items[index], _Telling(pipe, index))))


class _Telling:
    """Tells the caller how much of an item is done, not more often than anyone could see."""

    def __init__(self, pipe: Pipe, index: int) -> None:
        self._pipe, self._index, self._told = pipe, index, 0.0

    def __call__(self, share: float) -> None:
        if share - self._told >= WORTH_TELLING:
            self._told = share
            self._pipe.send(_Share(self._index, share))


class _Answer:
    """A block whose error is sent to the caller, who raises it."""

    def __init__(self, pipe: Pipe) -> None:
        self._pipe = pipe

    def __enter__(self) -> None:
        return

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> bool:
        if not isinstance(error, Exception) or isinstance(error, BrokenPipeError | ConnectionResetError):
            return False
        where = "".join(traceback.format_exception(error))
        self._pipe.send(_Failed(_portable(error, where)))
        return True


def _portable(error: Exception, where: str) -> Exception:
    """Return an error that reaches the caller, with the place in the worker where it happened."""
    error.add_note(f"In worker process {os.getpid()}:\n{where}")
    try:
        pickle.loads(pickle.dumps(error))
    except (pickle.PicklingError, TypeError, AttributeError, ValueError):
        return RuntimeError(f"{type(error).__name__} in worker process {os.getpid()}:\n{where}")
    return error
