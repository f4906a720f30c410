"""Names that a command can write, checked before any work is done."""

import os
from collections.abc import Sequence
from pathlib import Path

from bench.errors import InputError, not_utf_8


def expect_nameable(arguments: Sequence[str], out: Path | None) -> None:
    """Refuse names that are no UTF-8 for a command that writes: its files name what they were made of, and where.

    Args:
        arguments: As they were typed.
        out: What it writes; None: nothing is written, and any name will do.

    Raises:
        InputError: An argument, or a folder that `out` lies in, has a name that is no UTF-8, or it lies nowhere.
    """
    if out is None:
        return
    for argument in arguments:
        if shown := not_utf_8(argument):
            raise InputError(f"{shown}: is no UTF-8, and what is written names it; choose another name")
    try:
        place = os.path.realpath(out)
    except FileNotFoundError as error:
        raise InputError(f"{out}: the folder that this runs in is gone; go to one that is there") from error
    if shown := not_utf_8(place):
        raise InputError(f"{out}: lies in {shown}, which is no UTF-8; write to another folder")
