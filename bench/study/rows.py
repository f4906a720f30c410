"""The file of a study: its settings in the first line, and every campaign that is done as one more.

It is written by one process while others may be killed, disks run full and lines be damaged; whatever happens, a line
that is whole counts, and no campaign counts twice. Each line names its study, so a damaged first line costs nothing.
"""

import json
import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any, Generic, Protocol, TextIO, TypeVar

from bench.errors import InputError

ROWS = "campaigns.jsonl"
STUDY = "study"  # key of a line that names its study
LENGTH = 8  # hexadecimal digits of that name


class Row(Protocol):
    """What came of one campaign, or of one machine."""

    @property
    def name(self) -> str:
        """Unique in its study."""

    def as_json(self) -> str:
        """Return it as one line."""


R = TypeVar("R", bound=Row)


@dataclass(frozen=True)
class Rows(Generic[R]):
    """What a file holds.

    Attributes:
        outcomes: Campaigns that are done, each once.
        damaged: Lines that could not be read, and are no longer there.
    """

    outcomes: tuple[R, ...]
    damaged: int


def read_rows(file: Path, settings: Mapping[str, Any], parse: Callable[[str], R]) -> Rows[R]:
    """Return the campaigns that are done, and leave a file in which nothing is damaged or doubled; makes a new one.

    Args:
        file: In a folder that exists.
        settings: Of the study, as plain data; "code" is its fingerprint.
        parse: Reads a row from its line; ValueError where that is not whole.

    Raises:
        InputError: The file is of another study, or was made by other code.
    """
    head = json.dumps(settings)
    if not file.exists():
        _rewrite(file, head, ())
        return Rows((), 0)
    first, *lines = file.read_bytes().split(b"\n")
    name = study_of(settings)
    parsed = [(line, _parsed(line)) for line in lines if line.strip()]
    _expect_same(file, _dictionary(first), settings, any(row.get(STUDY) == name for _, row in parsed))
    outcomes: dict[str, R] = {}
    whole = 0
    for line, row in parsed:
        try:
            outcome = parse(line.decode())
        except (ValueError, RecursionError):
            continue
        if row.get(STUDY, name) == name:
            whole += 1
            outcomes.setdefault(outcome.name, outcome)
    if first != head.encode() or lines[-1:] != [b""] or len(outcomes) < len(lines) - 1:
        _rewrite(file, head, (line_of(outcome, name) for outcome in outcomes.values()))
    return Rows(tuple(outcomes.values()), len(parsed) - whole)


def append(stream: TextIO, outcome: Row, study: str) -> None:
    """Write a campaign that is done, so that it is there even if the process is killed next."""
    stream.write(line_of(outcome, study) + "\n")
    stream.flush()
    os.fsync(stream.fileno())


def line_of(outcome: Row, study: str) -> str:
    """Return a campaign as a line."""
    return json.dumps({STUDY: study} | json.loads(outcome.as_json()))


def study_of(settings: Mapping[str, Any]) -> str:
    """Return the name that lines give to a study."""
    return sha256(json.dumps(settings).encode()).hexdigest()[:LENGTH]


def _parsed(line: bytes) -> dict[str, Any]:
    return _dictionary(line) or {}


def _dictionary(line: bytes) -> dict[str, Any] | None:
    """Return what a line holds, None where it is damaged."""
    try:
        content = json.loads(line.decode())
    except (ValueError, RecursionError):
        return None
    return content if isinstance(content, dict) else None


def _expect_same(file: Path, head: dict[str, Any] | None, settings: Mapping[str, Any], is_named: bool) -> None:
    mine: dict[str, Any] = json.loads(json.dumps(settings))
    if head == mine or (head is None and is_named):
        return
    if head is None:
        raise InputError(
            f"{file}: its first line is damaged, and no other says which study it is; choose another folder."
        )
    of_code = {"code", "version"}
    if {k: v for k, v in head.items() if k not in of_code} != {k: v for k, v in mine.items() if k not in of_code}:
        raise InputError(f"{file}: is of a study with other settings; choose another folder.")
    raise InputError(
        f"{file}: was begun by other code ({head.get('code', 'of an earlier version')}, this is {mine['code']}), whose "
        "results are not to be mixed with these; choose another folder, or go on with the code that began it."
    )


def _rewrite(file: Path, head: str, lines: Iterable[str]) -> None:
    partial = file.with_name(f".{file.name}.partial")
    try:
        with partial.open("w", encoding="utf-8") as stream:
            stream.writelines(f"{line}\n" for line in (head, *lines))
            stream.flush()
            os.fsync(stream.fileno())
        partial.replace(file)
    finally:
        partial.unlink(missing_ok=True)
