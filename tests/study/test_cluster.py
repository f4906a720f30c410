"""A study on a cluster: a scheduler and two workers as processes of their own, one of them killed in the middle."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from bench.errors import InputError
from bench.executor.cluster import Cluster
from bench.executor.contract import in_order
from bench.study.plan import Counts
from bench.study.rows import ROWS
from bench.study.study import Settings, run_study
from tests.executor import work
from tests.study.stub import Stub

pytest.importorskip("distributed")

ROOT = Path(__file__).parents[2]
COUNTS = Counts(seeds=0, nulls=24, unlisted=0, pairs=0, twins=False)
HELD = "null 9"
PATIENCE_S = 60.0


@contextmanager
def process(*arguments: str) -> Iterator["subprocess.Popen[bytes]"]:
    """Start a part of Dask that is ended with the block."""
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    started = subprocess.Popen([sys.executable, "-m", *arguments], cwd=ROOT, **quiet)  # type: ignore[call-overload]
    try:
        yield started
    finally:
        started.kill()
        started.wait()


def begun(file: Path) -> str:
    """Return the content of a file once it is there."""
    until = time.monotonic() + PATIENCE_S
    while not file.exists() or not file.read_text():
        assert time.monotonic() < until
        time.sleep(0.05)
    return file.read_text()


def started(folder: Path, workers: int, threads: int, stack: ExitStack) -> tuple[str, "list[subprocess.Popen[bytes]]"]:
    """Return the address of a scheduler, and its workers."""
    file = folder / "scheduler.json"
    local = ("--host", "127.0.0.1", "--no-dashboard")
    command = ("distributed.cli.dask_scheduler", *local, "--port", "0", "--scheduler-file", str(file))
    stack.enter_context(process(*command))
    address = json.loads(begun(file))["address"]
    options = (*local, "--no-nanny", "--nthreads", str(threads), "--local-directory", str(folder))
    return address, [
        stack.enter_context(process("distributed.cli.dask_worker", address, *options)) for _ in range(workers)
    ]


def test_a_worker_that_is_killed_costs_nothing(tmp_path: Path) -> None:
    settings = Settings(counts=COUNTS)
    (folder := tmp_path / "begun").mkdir()
    killed: list[int] = []

    def kills(share: float) -> None:
        if not killed and (folder / HELD).exists() and (pid := (folder / HELD).read_text()):
            os.kill(int(pid), signal.SIGKILL)
            killed.append(int(pid))

    with ExitStack() as stack:
        address, workers = started(tmp_path, 2, 1, stack)
        with Cluster(address) as cluster:
            outcomes = run_study(settings, tmp_path, cluster, kills, work=Stub(settings, folder, HELD))
        assert killed[0] in [worker.pid for worker in workers]
        assert len((folder / HELD).read_text().split()) == 2  # it was begun again, elsewhere
        assert str(killed[0]) != (folder / HELD).read_text().split()[1]
    names = [f"null {i + 1}" for i in range(COUNTS.nulls)]
    assert [outcome.name for outcome in outcomes] == names
    rows = [json.loads(line)["name"] for line in (tmp_path / ROWS).read_text().splitlines()[1:]]
    assert sorted(rows) == sorted(names)


def test_what_work_raises_on_a_cluster_is_raised_here(tmp_path: Path) -> None:
    with ExitStack() as stack:
        address, _ = started(tmp_path, 1, 1, stack)
        with Cluster(address) as cluster:
            assert in_order(cluster, work.square, range(4)) == [0, 1, 4, 9]
            assert in_order(cluster, work.square, []) == []
            pids = in_order(cluster, work.nested, [0])[0]
            assert len(set(pids)) == 1
            with pytest.raises(InputError, match="two is bad"):
                in_order(cluster, work.fails_at_two, range(4))


def test_a_worker_with_several_threads_is_refused(tmp_path: Path) -> None:
    with ExitStack() as stack:
        address, _ = started(tmp_path, 1, 2, stack)
        with Cluster(address) as cluster, pytest.raises(InputError, match="--nthreads 1"):
            in_order(cluster, work.square, range(4))


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nonsense://"])
def test_a_scheduler_that_is_not_there_is_named(address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bench.executor.cluster.PATIENCE_S", 0.5)
    with pytest.raises(InputError, match="no scheduler answers"):
        Cluster(address)
