"""What is stated once for all drives, or as a list with one number for each."""

from collections.abc import Iterator, Mapping
from typing import Annotated, TypeVar

import numpy as np
from pydantic import Discriminator, Tag

from bench.robot.bodies import Array, read_only

NUMBER, LIST = "one number", "a list"  # names by which pydantic tells the two apart, left out where a place is told

T = TypeVar("T")


def _form(value: object) -> str:
    return LIST if isinstance(value, list | tuple) else NUMBER


# A number is held to T alone, and a list number by number: one fault each, where pydantic would try both
OneOrEach = Annotated[Annotated[T, Tag(NUMBER)] | Annotated[tuple[T, ...], Tag(LIST)], Discriminator(_form)]


def of_each(stated: float | tuple[float, ...], n: int) -> Array:
    """Return what is stated of each of n drives, shape (n,)."""
    return read_only(stated if isinstance(stated, tuple) else np.full(n, stated))


def wrong_lengths(stated: Mapping[str, object], n: int) -> Iterator[str]:
    """Yield a sentence for each list that is not one of n numbers.

    Args:
        stated: Place in the file -> what stands there.
        n: Number of drives.
    """
    for place, value in stated.items():
        if isinstance(value, tuple) and len(value) != n:
            yield f"{place} needs one number, or one for each of the {n} drives, not a list of {len(value)}"
