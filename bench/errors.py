"""What goes wrong, said once: the place, what was wrong there, and what to do.

Every error that a user can cause is a `BenchError`. The command line prints it without a traceback and ends with its
`exit_code`; the codes are part of the interface and stand in README.md.
"""

import os
import re
from collections.abc import Iterable, Sequence
from difflib import get_close_matches

MOST_OF_NAME = 100  # characters of a name that a message repeats; some files have one of a million
MORE_MEMORY = "give it more (ulimit -v, the limit of a container or of a job), or end what else runs"
UNMAPPED = (
    "cannot map",
    "failed to map",
    "annot allocate memory",
    "cannot apply additional memory protection",
)  # glibc
UNPRINTABLE = re.compile(r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069]")


class BenchError(Exception):
    """Root of all errors of this package.

    Attributes:
        exit_code: What the `bench` command returns when this error ends it.
    """

    exit_code = 1


class InputError(BenchError):
    """A file, an option or a value that the user gave cannot be used.

    `problems` holds every fault that was found, each naming its place ("loading.yaml: poses[2].q_deg[1]"), so that all
    can be mended at once.
    """

    exit_code = 2

    def __init__(self, problems: str | Iterable[str]) -> None:
        self.problems: tuple[str, ...] = (problems,) if isinstance(problems, str) else tuple(problems)
        super().__init__(printable("\n".join(self.problems)))


class ScenarioError(InputError):
    """A scenario that cannot be had on its robot; the places are keys of its file, which whoever read it knows."""


class CampaignError(InputError):
    """A campaign folder that breaks the format of `bench/record/README.md`."""

    exit_code = 3


class RobotError(InputError):
    """A robot folder that breaks the format of `models/README.md`."""

    exit_code = 4


class UnknownRobotError(RobotError):
    """A name that is neither a robot that comes along nor a robot folder."""


class ConvergenceError(BenchError):
    """An iteration that did not settle; the message gives the residual reached and the one asked for."""

    exit_code = 5


# What a model that is only tried may end in. It is no explanation then; an effect of the user's own that fails is said.
NOT_SIMULATED = (ConvergenceError, RobotError)


class MissingPluginError(BenchError):
    """The engine plugin with the counterbalance and friction actuators is not installed or was not built."""

    exit_code = 6


class NoLibraryError(BenchError):
    """A library that the bench needs cannot be loaded: memory is short, or it is not installed as it should be."""

    exit_code = 6


def interrupt_behind(error: BaseException | None) -> KeyboardInterrupt | None:
    """Return the interrupt that an error is, or that led to it; None where there is none.

    An extension that is interrupted while it is loaded says that it could not be, and so does a class while it is made.
    """
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error


def not_loaded(error: ImportError) -> str:
    """Return the sentence for a library that cannot be loaded: the system's own words, and what to do."""
    words = str(error)
    of = f"{error.name}: " if error.name and error.name not in words else ""
    remedy = MORE_MEMORY if any(sign in words for sign in UNMAPPED) else "install the bench again, with all it needs"
    return f"a library cannot be loaded: {of}{words}; {remedy}."


def printable(text: str) -> str:
    """Return a text with control characters escaped: names in files of strangers must not steer a terminal."""
    return UNPRINTABLE.sub(lambda found: found[0].encode("unicode_escape").decode(), text)


def not_utf_8(name: str) -> str:
    r"""Return a file's name that is no UTF-8, its odd bytes as \x80; "" for any other name."""
    try:
        name.encode()
    except UnicodeEncodeError:  # Python keeps such bytes as halves of surrogate pairs
        return os.fsencode(name).decode(errors="backslashreplace")
    return ""


def unknown_name(what: str, name: str, known: Iterable[str]) -> str:
    """Return the sentence for an unknown name: what it is, the nearest known one, and all known ones."""
    listed = sorted(known)
    return f"{_not_known(what, name, listed)} {_known(listed)}"


def unknown_names(what: str, names: Iterable[str], known: Iterable[str]) -> tuple[str, ...]:
    """Return a sentence for each name that is not known, then one that lists the known ones; none if all are known."""
    listed = sorted(known)
    found = [_not_known(what, name, listed) for name in names if name not in listed]
    return (*found, _known(listed)) if found else ()


def _not_known(what: str, name: str, listed: Sequence[str]) -> str:
    near = get_close_matches(name, listed, n=1)
    return f"unknown {what} {name[:MOST_OF_NAME]!r}." + (f" Did you mean {near[0]!r}?" if near else "")


def _known(listed: Sequence[str]) -> str:
    return f"Known: {', '.join(listed) or 'none'}."
