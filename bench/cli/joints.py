"""Which joint has which number: a line above answers that number them."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bench.robot.compiled import CompiledRobot


def by_number(compiled: "CompiledRobot") -> Iterator[str]:
    """Yield that line, unless the names of the joints end with their numbers."""
    if words := compiled.robot.figures.by_number:
        yield f"Joints, drives and channels by number: {words}."
