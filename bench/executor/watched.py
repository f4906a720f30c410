"""Work that somebody looks after: it shows how far it is, and ends when it is asked to."""

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import dataclass
from math import inf
from time import monotonic

from bench.executor.contract import Done, Executor, Item, Progress, Result, Work, ignore

Check = Callable[[], None]


class Stopped(Exception):  # noqa: N818  # a wish, not an error
    """Somebody asked the work that is under way to end with what it has; the message says who."""


def never() -> None:
    """Check whether to end, where nobody ever asks for it."""


class Stop:
    """Says when work shall end: after some time, or when it is asked to.

    Args:
        seconds: From now on; inf: only when asked.
        clock: Seconds that pass.
    """

    def __init__(self, seconds: float = inf, clock: Callable[[], float] = monotonic) -> None:
        self._clock = clock
        self._seconds = seconds
        self._until = clock() + seconds
        self._asked = ""

    def ask(self, why: str) -> None:
        """Ask the work to end.

        Args:
            why: In words, such as "interrupted".
        """
        self._asked = self._asked or why

    @property
    def is_asked(self) -> bool:
        """Whether somebody asked, other than the clock."""
        return bool(self._asked)

    def check(self) -> None:
        """Return if the work may go on.

        Raises:
            Stopped: It shall end.
        """
        if self._asked:
            raise Stopped(self._asked)
        if self._clock() >= self._until:
            raise Stopped(f"ended after {self._seconds:g} s")


@dataclass(frozen=True)
class Watched:
    """Another executor, with somebody who is called as its work goes on.

    Attributes:
        executor: Does the work.
        check: Called until everything is done; what it raises ends the work.
        shows: Called with the share of each `map` that is done.
    """

    executor: Executor
    check: Check = never
    shows: Progress = ignore

    @property
    def shares_memory(self) -> bool:
        """As the other one."""
        return self.executor.shares_memory

    def map(
        self, work: Work[Item, Result], items: Sequence[Item], progress: Progress = ignore
    ) -> Generator[Done[Result], None, None]:
        """Yield what some work makes of every item; see `Executor.map`."""

        def watched(share: float) -> None:
            self.shows(share)
            if share < 1:
                self.check()
            progress(share)

        with closing(self.executor.map(work, items, watched)) as results:
            yield from results
