"""Commands that end early: by Ctrl-C, by their time, by a full disk; what is left is whole, or nothing."""

import json
import os
import re
import resource
import signal
import subprocess
import sys
import time
from contextlib import nullcontext
from pathlib import Path

import pytest

from bench.cli import TERMINATED, main
from bench.cli.stopping import UNFINISHED, TerminatedError, ending_at_a_signal, ending_on_interrupt, seconds_of
from bench.errors import interrupt_behind
from bench.executor.watched import Stop
from bench.report.diagnosis.file_names import REPORT, TEXT, VERDICT

STARTED_S = 60.0  # within which a run is under way on a busy machine


def started(*arguments: str, **more: object) -> "subprocess.Popen[str]":
    command = [sys.executable, "-c", "from bench.cli import main; import sys; sys.exit(main())", *arguments]
    return subprocess.Popen(  # type: ignore[call-overload, no-any-return]
        command,
        start_new_session=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **more,
    )


def members(group: int) -> list[int]:
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, _, of = stat.read_text().rpartition(")")[2].split()[:3]
        except OSError:
            continue
        if int(of) == group and state != "Z":
            found.append(int(stat.parent.name))
    return found


def under_way(command: str, campaign: Path, out: Path) -> "subprocess.Popen[str]":
    """Return a run whose workers are at work."""
    what = {"diagnose": [str(campaign)], "hide": ["--none"]}[command]
    process = started(command, *what, "-o", str(out))
    until = time.monotonic() + STARTED_S
    while not list(out.parent.glob(f".{out.name}*")):
        assert time.monotonic() < until
        assert process.poll() is None
        time.sleep(0.05)
    time.sleep(0.5)
    return process


@pytest.mark.parametrize("command", ["diagnose", "hide"])
def test_aborted_run_leaves_neither_files_nor_processes(command: str, healthy: Path, tmp_path: Path) -> None:
    """A diagnosis is aborted by the second Ctrl-C only."""
    process = under_way(command, healthy, tmp_path / "out")
    for _ in range(2 if command == "diagnose" else 1):
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        time.sleep(0.05)
    _, said = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "interrupted" in said
    assert "Traceback" not in said
    assert list(tmp_path.iterdir()) == []
    assert members(process.pid) == []


def test_the_first_ctrl_c_ends_with_what_was_found_so_far(healthy: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    process = under_way("diagnose", healthy, out)
    os.killpg(process.pid, signal.SIGINT)
    printed, said = process.communicate(timeout=120)
    assert process.returncode == UNFINISHED
    assert "Ctrl-C once more" in said
    assert "Traceback" not in said
    verdict = json.loads((out / VERDICT).read_text())
    assert verdict["unfinished"]["why"] == "interrupted"
    assert re.search("^Unfinished \\(interrupted, during: ", printed, re.MULTILINE)
    assert "Unfinished (interrupted" in (out / REPORT).read_text()
    assert members(process.pid) == []


def test_time_that_is_over_at_once_gives_a_verdict_all_the_same(
    healthy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["diagnose", str(healthy), "-o", str(out), "--at-most", "0.001s"]) == UNFINISHED
    first, second, *places = capsys.readouterr().out.splitlines()
    assert first.startswith("Unfinished (ended after 0.001 s, during: ")
    assert first.endswith("nothing was weighed yet, so nothing is known of any cause.")
    assert "was not looked for" in second
    assert [place.split()[0] for place in places] == ["report", "words", "numbers"]
    assert sorted(entry.name for entry in out.iterdir()) == [REPORT, VERDICT, TEXT]
    assert json.loads((out / VERDICT).read_text())["kind"] == "nothing weighed"
    assert "What would have been found" not in (out / REPORT).read_text()


@pytest.mark.parametrize(
    ("text", "seconds"), [("90", 90.0), ("60s", 60.0), ("2m", 120.0), (" 1.5 min", 90.0), ("1h", 3600.0), (".5", 0.5)]
)
def test_times_are_read(text: str, seconds: float) -> None:
    assert seconds_of(text) == seconds


def test_full_disk_is_named(tmp_path: Path) -> None:
    """Files beyond a size cannot be written, as on a disk that is full."""
    process = started(
        *("hide", "--none", "--scenario", "loading", "-o", str(tmp_path / "out")),
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)),
    )
    _, said = process.communicate(timeout=120)
    assert process.returncode == 2
    assert re.search(r"out.*: cannot be written \(.*\); free some space", said)
    assert list(tmp_path.iterdir()) == []


def test_an_extension_that_is_interrupted_while_it_is_loaded_is_no_error_of_the_bench() -> None:
    """SIGTERM while `import mujoco` ran ended in a traceback: "initialization failed"."""
    loading = ImportError("initialization failed")
    loading.__cause__ = TerminatedError()
    assert interrupt_behind(loading) is loading.__cause__
    assert interrupt_behind(ImportError("no such module")) is None


def test_a_class_that_is_interrupted_while_it_is_made_ends_a_command(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Python hides what `__set_name__` raises in a RuntimeError; a command that loaded its models ended in that."""

    class Named:
        def __set_name__(self, owner: type, name: str) -> None:
            raise TerminatedError

    def run(_: object) -> int:
        type("Owner", (), {"named": Named()})
        return 0

    monkeypatch.setattr("bench.cli._run", run)
    assert main([]) == TERMINATED
    assert capsys.readouterr().err == "bench: terminated; nothing half-written was left behind.\n"


@pytest.mark.parametrize(("number", "asked"), [(signal.SIGTERM, TerminatedError), (signal.SIGINT, KeyboardInterrupt)])
def test_a_request_to_end_that_became_another_error_is_one(
    number: signal.Signals, asked: type[KeyboardInterrupt]
) -> None:
    """While MuJoCo loaded EGL it came out as "ctypes.ArgumentError: argument 1: TerminatedError", with a traceback."""

    def hold() -> None:
        try:
            os.kill(os.getpid(), number)
        except KeyboardInterrupt:
            raise ValueError("argument 1: TerminatedError: ") from None  # as ctypes does; it keeps no cause either

    with pytest.raises(KeyboardInterrupt) as raised, ending_at_a_signal():
        hold()
    assert raised.type is asked
    with pytest.raises(ValueError, match="of its own"), ending_at_a_signal():
        raise ValueError("of its own")


@pytest.mark.parametrize("under_nohup", [False, True])
def test_a_terminal_that_is_gone_ends_a_command_but_not_one_under_nohup(under_nohup: bool) -> None:
    """SIGHUP of a connection that broke left a half-written folder behind."""
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN if under_nohup else signal.SIG_DFL)
    try:
        with nullcontext() if under_nohup else pytest.raises(TerminatedError), ending_at_a_signal():
            os.kill(os.getpid(), signal.SIGHUP)
        stop = Stop()
        with ending_on_interrupt(stop):
            os.kill(os.getpid(), signal.SIGHUP)
        assert stop.is_asked is not under_nohup
    finally:
        signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize(("number", "asked"), [(signal.SIGTERM, TerminatedError), (signal.SIGINT, KeyboardInterrupt)])
def test_a_request_to_end_that_python_ignored_comes_again(
    number: signal.Signals, asked: type[KeyboardInterrupt], capsys: pytest.CaptureFixture[str]
) -> None:
    """In the middle of a fork it was "Exception ignored in _releaseLock", and the command went on."""

    class Unheard:
        def __del__(self) -> None:  # as all that Python calls at a fork: what it raises is printed, and that is all
            os.kill(os.getpid(), number)

    def work() -> None:
        Unheard()
        time.sleep(10)

    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt) as raised, ending_at_a_signal():
        work()
    assert raised.type is asked
    assert time.monotonic() - begin < 5
    assert capsys.readouterr().err == ""


def test_ctrl_c_that_is_ignored_stays_ignored() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with ending_at_a_signal():
            os.kill(os.getpid(), signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)
