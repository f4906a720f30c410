"""One after the other, in the caller's own thread."""

from collections.abc import Generator, Sequence
from dataclasses import dataclass

from bench.executor.contract import Done, Item, Progress, Result, Work, ignore


@dataclass(frozen=True)
class Serial:
    """Does one item after the other."""

    @property
    def shares_memory(self) -> bool:
        """There is one memory."""
        return True

    def map(
        self, work: Work[Item, Result], items: Sequence[Item], progress: Progress = ignore
    ) -> Generator[Done[Result], None, None]:
        """Yield what some work makes of every item; see `Executor.map`."""
        n = len(items)

        def told(index: int) -> Progress:
            return lambda share: progress((index + share) / n)

        for index, item in enumerate(items):
            progress(index / n)
            yield Done(index, work(item, told(index)))
        progress(1.0)


SERIAL = Serial()
