"""What an executor is: `map` makes something of every item, and yields it as it comes."""

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")
Value = TypeVar("Value", covariant=True)
Progress = Callable[[float], None]
Work = Callable[[Item, Progress], Result]

POLL = 0.1  # [s], after which `progress` is called again though nothing is done; a stop takes no longer than that

_is_worker: ContextVar[bool] = ContextVar("is_worker", default=False)


@dataclass(frozen=True)
class Done(Generic[Value]):
    """What came of the item with an index."""

    index: int
    value: Value


def ignore(share: float) -> None:
    """Take a share that is done, and do nothing with it."""


class Executor(Protocol):
    """Does independent pieces of work."""

    @property
    def shares_memory(self) -> bool:
        """Whether workers have what the caller has in memory; otherwise each makes its own."""

    def map(
        self, work: Work[Item, Result], items: Sequence[Item], progress: Progress = ignore
    ) -> Generator[Done[Result], None, None]:
        """Yield what some work makes of every item, as it comes.

        Work that is under way ends when the generator is closed; who leaves it early closes it.

        Args:
            work: Called with an item and with a function that may be told which share of that item is done.
            items: What to work on.
            progress: Called in the caller's thread with the share of everything that is done, at the start, at every
                result and at least every `POLL` seconds meanwhile. What it raises ends the work.

        Raises:
            Exception: What the work raised, the first time that it raised anything.
        """


def in_order(
    executor: Executor, work: Work[Item, Result], items: Sequence[Item], progress: Progress = ignore
) -> list[Result]:
    """Return what some work makes of every item, in the order of the items; arguments as of `Executor.map`."""
    found: dict[int, Result] = {}
    with closing(executor.map(work, items, progress)) as results:
        for done in results:
            found[done.index] = done.value
    return [found[index] for index in range(len(items))]


def inside_worker() -> bool:
    """Return whether this is a worker of an executor."""
    return _is_worker.get()


def become_worker() -> None:
    """Make this thread's context, or this process, that of a worker."""
    _is_worker.set(True)
