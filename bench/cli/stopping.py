"""Work that ends early: after a time, or with the first Ctrl-C, SIGTERM or SIGHUP; the second one aborts."""

import os
import re
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

from bench.errors import InputError
from bench.executor.watched import Stop

UNITS_S = {"": 1.0, "s": 1.0, "m": 60.0, "min": 60.0, "h": 3600.0}
UNFINISHED = 7  # exit code
SOON_S = 0.01  # after which a signal that was ignored comes again
HEARD = b"\nbench: ends with what was found so far; Ctrl-C once more ends at once, without a result\n"


def seconds_of(text: str) -> float:
    """Return a time in seconds.

    Raises:
        InputError: It is none, or not more than zero.
    """
    match = re.fullmatch(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*([a-z]*)\s*", text)
    seconds = float(match[1]) * UNITS_S.get(match[2], 0.0) if match else 0.0
    if seconds <= 0:
        raise InputError(f"--at-most {text}: is no time; give seconds, minutes or hours, as 90, 60s, 2m or 1h.")
    return seconds


@contextmanager
def ending_on_interrupt(stop: Stop) -> Iterator[None]:
    """Let the first Ctrl-C, SIGTERM or SIGHUP within the block ask the work to end, and only the second one abort it.

    Raises:
        KeyboardInterrupt: At the second one.
    """

    def heard(number: int, frame: FrameType | None) -> None:
        if stop.is_asked:
            raise KeyboardInterrupt
        stop.ask("interrupted")
        with suppress(OSError):  # nobody reads it any more
            os.write(2, HEARD)  # print may be in the middle of a line of its own

    with _hearing(heard, signal.SIGINT, signal.SIGTERM, *_hangup()):
        yield


def _hangup() -> tuple[int, ...]:
    """Return the signal of a terminal that is gone, as of a connection that broke; none where nohup ignores it."""
    number = getattr(signal, "SIGHUP", None)  # which Windows has not
    return (number,) if number is not None and signal.getsignal(number) is not signal.SIG_IGN else ()


@contextmanager
def _hearing(heard: Callable[[int, FrameType | None], None], *numbers: int) -> Iterator[None]:
    """Call a function at signals within the block; in another thread than the main one there are none."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.signal(number, heard) for number in numbers}
    try:
        with _sent_again_where_ignored():
            yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def _sent_again_where_ignored() -> Iterator[None]:
    """Within the block, send a signal once more whose exception Python ignored, as it does in what runs around a fork.

    The second one comes from another thread and a little later: within the hook itself it would be ignored as well.
    """
    before = sys.unraisablehook
    main = threading.main_thread().ident
    assert main is not None

    def ignored(what: "sys.UnraisableHookArgs") -> None:
        if not isinstance(what.exc_value, KeyboardInterrupt):
            before(what)
            return
        number = signal.SIGTERM if isinstance(what.exc_value, TerminatedError) else signal.SIGINT
        again = threading.Timer(SOON_S, signal.pthread_kill, (main, number))
        again.daemon = True
        again.start()

    sys.unraisablehook = ignored
    try:
        yield
    finally:
        sys.unraisablehook = before


class TerminatedError(KeyboardInterrupt):
    """A request to end that was not typed, from a scheduler or a system that shuts down."""


@contextmanager
def ending_at_a_signal() -> Iterator[None]:
    """Let Ctrl-C, SIGTERM and SIGHUP within the block end it, whatever the code that they interrupt makes of them.

    Ctrl-C that the process was started to ignore, as a shell does for work in the background, stays ignored.

    Raises:
        KeyboardInterrupt: At Ctrl-C, or after it in the place of whatever error it became: ctypes raises another one
            that says no more of it.
        TerminatedError: The same at SIGTERM, and where the terminal is gone.
    """
    asked: list[type[KeyboardInterrupt]] = []

    def heard(number: int, frame: FrameType | None) -> None:
        asked.append(KeyboardInterrupt if number == signal.SIGINT else TerminatedError)
        raise asked[-1]

    is_python_s = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    with _hearing(heard, signal.SIGTERM, *_hangup(), *((signal.SIGINT,) if is_python_s else ())):
        try:
            yield
        except Exception as error:  # whatever it is: after the signal it may be what became of it
            if asked:
                raise asked[-1] from error
            raise
