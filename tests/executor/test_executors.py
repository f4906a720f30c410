"""Executors of one machine: the same results everywhere, in order, and nothing left behind."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from bench.errors import InputError
from bench.executor.contract import POLL, Executor, in_order
from bench.executor.local import on_cores
from bench.executor.processes import CAN_FORK, Processes, WorkerLostError
from bench.executor.serial import SERIAL, Serial
from bench.executor.threads import Threads
from tests.executor import work

FORKED = [pytest.param(Processes(2, "fork"), id="fork")] if CAN_FORK else []
EVERY = [
    pytest.param(SERIAL, id="serial"),
    pytest.param(Threads(2), id="threads"),
    *FORKED,
    pytest.param(Processes(2, "spawn"), id="spawn"),
]
STARTS = ["fork", "spawn"] if CAN_FORK else ["spawn"]
IN_PROC = pytest.mark.skipif(not Path("/proc").is_dir(), reason="processes are looked up in /proc")
PATIENCE_S = 60.0


@pytest.mark.parametrize("executor", EVERY)
def test_results_come_in_order_with_the_share_that_is_done(executor: Executor) -> None:
    told: list[float] = []
    assert in_order(executor, work.square, range(7), told.append) == [i * i for i in range(7)]
    assert told[0] == 0.0
    assert told[-1] == 1.0
    assert told == sorted(told)


@pytest.mark.parametrize("executor", EVERY)
def test_nothing_to_do(executor: Executor) -> None:
    assert in_order(executor, work.square, []) == []


@pytest.mark.parametrize("executor", EVERY)
def test_the_share_of_an_item_counts(executor: Executor) -> None:
    told: list[float] = []
    in_order(executor, work.halfway, range(2), told.append)
    assert any(0 < share < 0.5 or 0.5 < share < 1 for share in told)


@pytest.mark.parametrize("executor", EVERY)
def test_what_work_raises_is_raised_as_it_was(executor: Executor) -> None:
    with pytest.raises(InputError) as caught:
        in_order(executor, work.fails_at_two, range(4))
    assert caught.value.problems == ("two is bad", "worse than one")


@pytest.mark.parametrize("executor", EVERY)
def test_an_error_that_cannot_be_pickled_is_told_all_the_same(executor: Executor) -> None:
    with pytest.raises(Exception, match="item 0"):  # of a class that nobody can import
        in_order(executor, work.fails_oddly, [0, 0])


@pytest.mark.parametrize("executor", EVERY)
def test_inside_a_worker_everything_is_serial(executor: Executor) -> None:
    for pids in in_order(executor, work.nested, range(2)):
        is_serial = isinstance(executor, Serial)
        assert is_serial or set(pids) == {pids[-1]}


@pytest.mark.parametrize("executor", [*FORKED, pytest.param(Threads(2), id="threads")])
def test_work_and_items_need_not_be_pickled(executor: Executor) -> None:
    functions = [lambda i=i: i for i in range(3)]
    assert in_order(executor, lambda item, progress: item(), functions) == [0, 1, 2]


@pytest.mark.parametrize("executor", EVERY)
def test_floating_point_errors_are_what_the_caller_makes_of_them(executor: Executor) -> None:
    if getattr(executor, "start", "") == "spawn":
        pytest.skip("a process that begins with nothing begins with NumPy's own")
    with np.errstate(divide="raise"), pytest.raises(FloatingPointError):
        in_order(executor, lambda item, progress: np.float64(1.0) / np.float64(item), [0, 0])


@pytest.mark.parametrize("executor", EVERY)
def test_who_watches_may_end_it(executor: Executor) -> None:
    class EnoughError(Exception):
        """Seen."""

    def enough(share: float) -> None:
        if share > 0:
            raise EnoughError

    with pytest.raises(EnoughError):
        in_order(executor, work.square, range(50), enough)


@pytest.mark.parametrize("start", STARTS)
def test_a_worker_that_is_killed_is_named(start: str) -> None:
    with pytest.raises(WorkerLostError, match=r"exit code -9"):
        in_order(Processes(2, start), work.dies, range(4))  # type: ignore[arg-type]


def test_one_core_needs_no_process() -> None:
    assert on_cores(1) is SERIAL
    assert on_cores(3) == (Processes(3) if CAN_FORK else Threads(3))
    assert on_cores(3, "spawn") == Processes(3, "spawn")


def test_where_nothing_can_be_forked_there_are_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bench.executor.local.CAN_FORK", False)
    assert on_cores(3) == Threads(3)


SLEEPER = """
import sys
from pathlib import Path
from bench.executor.contract import in_order
from bench.executor.processes import Processes
from tests.executor.work import sleeps
in_order(Processes(2, sys.argv[1]), sleeps, [Path(sys.argv[2])] * 2)
"""


def is_alive(pid: int) -> bool:
    try:
        return "Z" not in Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False


def sleeping(start: str, folder: Path) -> "tuple[subprocess.Popen[str], list[int]]":
    """Return a caller whose two workers are under way, and these."""
    with (folder.parent / "said").open("w") as said:
        caller = subprocess.Popen(
            [sys.executable, "-c", SLEEPER, start, str(folder)],
            stderr=said,
            text=True,
            start_new_session=True,
            cwd=Path(__file__).parents[2],
        )
    until = time.monotonic() + PATIENCE_S
    while len(workers := [int(file.name) for file in folder.iterdir()]) < 2:
        assert time.monotonic() < until
        time.sleep(POLL)
    return caller, workers


@IN_PROC
@pytest.mark.parametrize("start", STARTS)
def test_ctrl_c_ends_workers_at_once(start: str, tmp_path: Path) -> None:
    (folder := tmp_path / "workers").mkdir()
    caller, workers = sleeping(start, folder)
    os.killpg(caller.pid, signal.SIGINT)  # as a terminal does
    caller.wait(timeout=PATIENCE_S)
    said = (tmp_path / "said").read_text()
    assert said.count("Traceback") == 1  # the caller's own: this script does not catch it
    assert said.strip().endswith("KeyboardInterrupt")
    assert not any(is_alive(worker) for worker in workers)


@IN_PROC
@pytest.mark.parametrize("start", STARTS)
def test_a_worker_ends_when_its_caller_was_killed(start: str, tmp_path: Path) -> None:
    (folder := tmp_path / "workers").mkdir()
    caller, workers = sleeping(start, folder)
    caller.kill()
    caller.wait(timeout=PATIENCE_S)
    (folder / work.ENOUGH).touch()  # what is under way is finished, and nobody is there to be told
    until = time.monotonic() + PATIENCE_S
    while any(is_alive(worker) for worker in workers):
        assert time.monotonic() < until
        time.sleep(POLL)
    assert (tmp_path / "said").read_text() == ""
