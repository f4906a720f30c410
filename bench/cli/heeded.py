"""Options that count: each given once, and none that another one makes idle."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any, get_args

import tyro

from bench.errors import InputError

NEGATED = "--no-"


def expect_once(typed: Sequence[str], command: Any) -> None:
    """Refuse an option that is given twice: the last one counted, and files named before it were left out unsaid.

    Args:
        typed: Arguments as they were typed.
        command: Its dataclass, as tyro filled it; options that may be repeated are marked there.

    Raises:
        InputError: There is one.
    """
    names: dict[str, str] = {}
    repeatable: set[str] = set()
    for field in fields(command):
        option = f"--{field.name.replace('_', '-')}"
        marks = get_args(field.type)
        if tyro.conf.UseAppendAction in marks:
            repeatable.add(option)
        names |= {alias: option for mark in marks for alias in getattr(mark, "aliases", None) or ()}
    seen: set[str] = set()
    for word in typed:
        if word == "--":  # what follows are names
            return
        said, _, _ = word.partition("=")
        option = names.get(said) or (said.replace("_", "-") if said.startswith("--") else "")
        option = f"--{option.removeprefix(NEGATED)}" if option.startswith(NEGATED) else option
        if option and option in seen and option not in repeatable:
            raise InputError(f"{said}: is given twice; give it once (several values follow one another).")
        seen.add(option)


def expect_idle(options: Mapping[str, object], why: str) -> None:
    """Refuse options that are given and count for nothing.

    Args:
        options: Name -> value, false or None where it is not given.
        why: They do not count.

    Raises:
        InputError: There is one.
    """
    if given := [name for name, value in options.items() if value]:
        raise InputError(f"{', '.join(given)}: {why}; leave it out.")
