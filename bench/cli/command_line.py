"""A command as it is typed."""

import shlex
from dataclasses import fields
from typing import Any, get_args

import tyro

SHORT = {"out": "-o"}
WITHOUT_EFFECT = "cores"  # no result depends on it


def command_line(name: str, command: Any) -> str:
    """Return what to type to run a command again.

    Args:
        name: Of the command.
        command: Its dataclass, as tyro filled it; what has its default is left out.
    """
    words = ["bench", name]
    for field in fields(command):
        given, marks = getattr(command, field.name), get_args(field.type)
        if given == field.default or field.name == WITHOUT_EFFECT:
            continue
        option = field.name.replace("_", "-")
        flag = SHORT.get(field.name, f"--{option}")
        values = list(map(str, given)) if isinstance(given, tuple) else [str(given)]
        if tyro.conf.Positional in marks:
            words += values
        elif isinstance(given, bool):
            words.append(flag if given else f"--no-{option}")
        elif tyro.conf.UseAppendAction in marks:
            words += [word for value in values for word in (flag, value)]
        else:
            words += [flag, *values]
    return shlex.join(words)
