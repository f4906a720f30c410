"""Progress on standard error: a bar with the time that is left on a terminal, plain lines or nothing elsewhere."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress

LEAST_S = 0.1  # between two pictures of the bar


class Phases:
    """What is done now, one thing after the other, each with a bar of its own on a terminal and a line elsewhere."""

    def __init__(self, bars: "Progress | None", *, lines: bool = True) -> None:
        self._bars = bars
        self._lines = lines
        self._shown = 0.0
        self._task = bars.add_task("", total=1.0) if bars else None

    def phase(self, words: str) -> None:
        """Begin something; it is not known how long it takes."""
        if self._bars is None or self._task is None:
            if self._lines:
                print(f"... {words}", file=sys.stderr, flush=True)
            return
        self._bars.remove_task(self._task)
        self._task = self._bars.add_task(words, total=None)
        self._bars.refresh()

    def share(self, share: float) -> None:
        """Show how much of it is done, 0 to 1."""
        if self._bars is None or self._task is None:
            return
        self._bars.update(self._task, completed=share, total=1.0)
        if share >= 1 or monotonic() - self._shown > LEAST_S:
            self._shown = monotonic()
            self._bars.refresh()


@contextmanager
def phases(*, lines: bool = True) -> Iterator[Phases]:
    """Yield what shows one phase after the other; where there is no terminal, in lines, if they are wanted."""
    with _bars() as bars:
        yield Phases(bars, lines=lines)


@contextmanager
def progress_bar(title: str) -> Iterator[Callable[[float], None]]:
    """Show a bar with the time that is left; yield the function to call with the share that is done, 0 to 1."""
    with _bars() as bars:
        if bars is None:
            yield lambda share: None
            return
        shown = Phases(bars)
        shown.phase(title)
        yield shown.share


@contextmanager
def _bars() -> Iterator["Progress | None"]:
    """Yield bars, None where standard error is no terminal.

    They are drawn when there is something new, by the thread that works: one of their own would be lost in workers that
    are forked meanwhile.
    """
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True, auto_refresh=False) as bars:
        yield bars
