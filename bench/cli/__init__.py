"""The `bench` command: one file per subcommand, each importing what it needs only when it runs."""

import errno
import io
import os
import shutil
import sys
from contextlib import suppress
from itertools import pairwise
from pathlib import Path

import tyro

import bench
from bench.cli.apply import Apply
from bench.cli.benchmark import Benchmark
from bench.cli.check import Check
from bench.cli.compare import Compare
from bench.cli.convert import Convert
from bench.cli.demo import Demo
from bench.cli.diagnose import Diagnose
from bench.cli.effects import Effects
from bench.cli.heeded import expect_once
from bench.cli.hide import Hide
from bench.cli.identify import Identify
from bench.cli.memory import return_what_is_free, short_of_memory
from bench.cli.nameable import expect_nameable
from bench.cli.new_robot import NewRobot
from bench.cli.paper import Paper
from bench.cli.poses import Poses
from bench.cli.predict import Predict
from bench.cli.robots import Robots
from bench.cli.run import Run
from bench.cli.stopping import TerminatedError, ending_at_a_signal
from bench.cli.store import Store
from bench.cli.study import Study
from bench.cli.view import View
from bench.errors import (
    MOST_OF_NAME,
    BenchError,
    InputError,
    NoLibraryError,
    interrupt_behind,
    not_loaded,
    printable,
)

Command = (  # in the order of the help; each goes by the name of its class
    Paper
    | Run
    | View
    | Identify
    | Poses
    | Diagnose
    | Compare
    | Predict
    | Apply
    | Demo
    | Study
    | Store
    | Effects
    | Hide
    | Check
    | Convert
    | Robots
    | NewRobot
    | Benchmark
)

TRYING_MODELS = (Diagnose, Compare, Predict, Demo, Study)  # what the engine warns of there is of models that are tried
INTERRUPTED = 130
TERMINATED = 143
NOT_READ = 141
GRAPHICS = "MUJOCO_GL"
PICTURES = {"MPLBACKEND": "agg"}  # all are files; what stands there may be a notebook's, or no backend at all
NARROWEST = 20  # columns; tables of help take for ever to be laid out in one to four
NO_TEMPORARY = "No usable temporary directory"  # as Python says it
REFUSED = (errno.EACCES, errno.EPERM, errno.ENAMETOOLONG, errno.ELOOP)  # by the system, whatever is done with a file
UNPRINTED = (errno.EPIPE, errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF)


def main(arguments: list[str] | None = None) -> int:
    """Run the command line; return its exit code (README.md lists them)."""
    if sys.stderr is None:  # closed, as a daemon starts: what is said goes nowhere
        sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115 (to the end of the process)
    if sys.stdout is None:
        print("bench: what it prints cannot be written: its output is closed; send it to /dev/null", file=sys.stderr)
        return InputError.exit_code
    _print_anything()
    os.environ.update(PICTURES)
    try:
        code = _ended(arguments)
        sys.stdout.flush()  # an error of the output at the exit of Python would come too late to be told
        return code
    except OSError as error:
        if error.filename is not None or error.errno not in UNPRINTED:  # of files, it is an error of the bench
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # what is left is flushed at the end
        if error.errno == errno.EPIPE:  # as with `bench ... | head`: nobody reads on
            return NOT_READ
        with suppress(OSError):  # where that is full as well
            print(f"bench: what it prints cannot be written: {error.strerror}", file=sys.stderr, flush=True)
        return InputError.exit_code


def _ended(arguments: list[str] | None) -> int:
    """Run the command line, say why it ended if it did not come to its end, and return the exit code."""
    try:
        with ending_at_a_signal():
            return _run(arguments)
    except BenchError as error:
        print(f"bench: {error}", file=sys.stderr)
        return error.exit_code
    except (KeyboardInterrupt, Exception) as error:
        interrupt = interrupt_behind(error)
        if interrupt is None:
            if (told := _of_surroundings(error)) is None:
                raise
            words, code = told
            print(f"bench: {words}", file=sys.stderr)
            return code
        is_typed = not isinstance(interrupt, TerminatedError)
        word = "interrupted" if is_typed else "terminated"
        print(f"bench: {word}; nothing half-written was left behind.", file=sys.stderr)
        return INTERRUPTED if is_typed else TERMINATED


def _of_surroundings(error: BaseException) -> tuple[str, int] | None:
    """Return the sentence and the exit code for what the machine does not give; None for an error of the bench."""
    if short := short_of_memory(error):
        return short, InputError.exit_code
    if isinstance(error, OSError) and error.errno in (errno.EMFILE, errno.ENFILE):
        return f"{error.strerror}; let it open more (ulimit -n), and end what holds many", InputError.exit_code
    if isinstance(error, OSError) and error.filename is not None and error.errno in REFUSED:
        named = str(error.filename)
        shown = printable(named[:MOST_OF_NAME] + "..." * (len(named) > MOST_OF_NAME))
        return f"{shown}: {error.strerror}; make it readable, or name another", InputError.exit_code
    if isinstance(error, FileNotFoundError) and NO_TEMPORARY in str(error):
        return f"{error.strerror}; free some space there, or name another in TMPDIR", InputError.exit_code
    if isinstance(error, ImportError | RuntimeError) and GRAPHICS in str(error):  # as MuJoCo refuses it
        return f"{error}; egl, osmesa or glfw, or leave it out", InputError.exit_code
    if isinstance(error, ImportError) and not str(error.name).startswith(bench.__name__):
        return not_loaded(error), NoLibraryError.exit_code
    return None


def _run(arguments: list[str] | None) -> int:
    typed = sys.argv[1:] if arguments is None else arguments
    if typed == ["--version"]:
        print(f"bench {bench.__version__}")
        return 0
    try:
        command: Command = tyro.cli(
            Command,
            args=arguments,
            prog="bench",
            description=__doc_for_users__,
            config=(tyro.conf.OmitSubcommandPrefixes,),
        )
    finally:
        sys.stdout.flush()  # help ends the program here
    _expect_no_empty(typed)
    expect_once(typed, command)
    expect_nameable(typed, Path(command.name) if isinstance(command, NewRobot) else getattr(command, "out", None))
    return_what_is_free()
    if not isinstance(command, TRYING_MODELS):
        return command.run()
    from bench.simulate.silence import engine_silent

    with engine_silent():
        return command.run()


def _expect_no_empty(typed: list[str]) -> None:
    """Refuse an empty argument: a path that is empty is the current folder, which nobody meant.

    Raises:
        InputError: There is one.
    """
    for before, argument in pairwise(["", *typed]):
        if not argument:
            place = f"{before}: " if before.startswith("-") else ""
            raise InputError(f"{place}an empty argument; is a variable of the shell empty? The folder here is a dot.")


def _print_anything() -> None:
    """Let a terminal that does not know a character get it escaped, and one of no width lines of some."""
    if shutil.get_terminal_size().columns < NARROWEST:
        os.environ["COLUMNS"] = str(NARROWEST)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


__doc_for_users__ = (
    "Virtual test bench for heavy industrial robots with a counterbalance: what does a simulation get wrong about "
    "measured data, and why? Start with `bench demo`, which hides an effect and finds it."
)
