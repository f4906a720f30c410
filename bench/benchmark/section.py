"""What a section of the benchmark gives."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One figure.

    Attributes:
        name: What was measured.
        value: How much of it, in `unit`; nan if only the ratio says something.
        unit: SI unit, or what is counted.
        ratio: A pure number measured in the same run, most often against something else; None: there is none.
        ratio_to: What the ratio is, to be read after it.
    """

    name: str
    value: float
    unit: str
    ratio: float | None = None
    ratio_to: str = ""


@dataclass(frozen=True)
class Section:
    """A part of the benchmark.

    Attributes:
        title: One line.
        measure: (robot folders) -> rows.
        needs: Package that it cannot do without, with the extra that brings it; empty: none.
    """

    title: str
    measure: Callable[[Sequence[str]], list[Row]]
    needs: tuple[str, str] = ("", "")
