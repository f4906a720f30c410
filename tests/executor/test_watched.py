"""Work that is asked to end; seconds are those of a clock that stands in a list."""

import pytest

from bench.executor.contract import Executor, in_order
from bench.executor.processes import Processes
from bench.executor.serial import SERIAL
from bench.executor.threads import Threads
from bench.executor.watched import Stop, Stopped, Watched
from tests.executor import work


def test_time_is_up_when_the_clock_says_so() -> None:
    now = [100.0]
    stop = Stop(60.0, clock=lambda: now[0])
    now[0] = 159.9
    stop.check()
    now[0] = 160.0
    with pytest.raises(Stopped, match="60 s"):
        stop.check()
    assert not stop.is_asked


def test_who_asks_first_is_named() -> None:
    stop = Stop()
    stop.check()
    stop.ask("interrupted")
    stop.ask("again")
    assert stop.is_asked
    with pytest.raises(Stopped, match="interrupted"):
        stop.check()


@pytest.mark.parametrize("executor", [SERIAL, Threads(2), Processes(2)], ids=["serial", "threads", "processes"])
def test_what_came_before_the_end_is_kept(executor: Executor) -> None:
    stop = Stop()
    found: list[int] = []

    def five_of_them() -> None:
        for done in Watched(executor, stop.check).map(work.square, range(20)):
            found.append(done.value)
            if len(found) == 5:
                stop.ask("enough")

    with pytest.raises(Stopped):
        five_of_them()
    assert len(found) == 5


def test_work_whose_last_item_is_done_is_not_stopped() -> None:
    stop = Stop()

    def shows(share: float) -> None:
        if share == asked_at:
            stop.ask("enough")

    asked_at = 1.0
    assert in_order(Watched(SERIAL, stop.check, shows), work.square, range(2)) == [0, 1]
    stop, asked_at = Stop(), 0.5
    with pytest.raises(Stopped):
        in_order(Watched(SERIAL, stop.check, shows), work.square, range(2))
