"""Columns that belong together: one for each drive, of one quantity."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

Kind = Literal["position", "link", "velocity", "acceleration", "current", "torque", "temperature", "unknown"]


@dataclass(frozen=True)
class Family:
    """A quantity of all drives, guessed.

    Attributes:
        kind: What it seems to be; "unknown": it moves, and nothing tells what it is.
        is_command: Whether it was commanded, not measured.
        sources: Columns of the log, one for each drive from the base to the tool.
        numbers: Of the drives, from 1.
        unit: Unit in its name, in lower case; "" if there is none.
        why: What the guess was made from.
    """

    kind: Kind
    is_command: bool
    sources: tuple[str, ...]
    unit: str
    why: str
    numbers: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if not self.numbers:
            object.__setattr__(self, "numbers", tuple(range(1, len(self.sources) + 1)))

    @property
    def shown(self) -> str:
        """Its columns in words."""
        return span(self.sources)


def span(names: Sequence[str]) -> str:
    """Return "q1 to q6"."""
    return names[0] if len(names) == 1 else f"{names[0]} to {names[-1]}"
