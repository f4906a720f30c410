"""By how much what is unknown is wider than stated: what the evidence and held-out errors choose of a prior."""

from dataclasses import dataclass, replace

import numpy as np

from bench.identify.dynamics.equations import OPTIONAL

WIDER = np.sqrt(10.0)  # effort: between one width and the next that is tried

WIDEST = 6  # effort: a thousand times what was stated; as good as unknown
NARROWEST = -4  # assumed: a hundredth of the whole torque; less would claim to know that there is none
AS_STATED = 0  # exact: once what was stated
# exact: nothing beyond what is stated, of an offset; of what is optional, none at all
NONE = NARROWEST - 1
# declared: friction bends in every gear; few joints have a dress pack or balancer, and nobody doubts that others do
# not. Friction that falls is told by time, which tells nothing else
SELDOM = ("spring", "balancer", "warming")


@dataclass(frozen=True)
class Widths:
    """By how much uncertainties are wider than stated, or than usual; powers of `WIDER`.

    All but `scale` are chosen by the evidence. Of scales of torques it says next to nothing where masses, payload and
    gas can follow them, and what then decides is what the model gets wrong; so held-out errors choose there.

    Attributes:
        figures: Of masses, centres and rotors; 0 or more, for what is stated is at least as uncertain as stated.
        friction: Of friction that is stated, likewise.
        offset: For each drive, of its torque offset beyond what is stated, which a first pass most easily takes for
            gravity; 0 or less.
        optional: Of each of `OPTIONAL`, for each drive; 0 or less. At `NONE`, where it begins, there is none: it bends
            in what a model misses elsewhere.
        held: Drives whose width of the offset stays at its least.
        stated: Drives of whose offset an uncertainty is stated: there is nothing beyond it (`NONE`) until the evidence
            wants more.
        stated_offset: Of what is stated of offsets, as of figures: offsets that data tell widen those of other drives.
        scale: Of the scales of torques; 0 as stated, or `NARROWEST`: torques are as they are read.
    """

    figures: int
    friction: int
    offset: tuple[int, ...]
    optional: tuple[int, ...]
    held: frozenset[int] = frozenset()
    stated: frozenset[int] = frozenset()
    stated_offset: int = AS_STATED
    scale: int = AS_STATED

    def least(self, drive: int) -> int:
        """Return the least width of a drive's offset."""
        return NONE if drive in self.stated else NARROWEST

    def all_free(self) -> "Widths":
        """Return these with offsets and optional friction as large as can be; what is `SELDOM` there as it is."""
        optional = tuple(w if self._name(i) in SELDOM else 0 for i, w in enumerate(self.optional))
        return replace(self, offset=(0,) * len(self.offset), optional=optional)

    def holding(self, drive: int) -> "Widths":
        """Return these with the offset of one more drive held."""
        return replace(self, offset=_with(self.offset, drive, self.least(drive)), held=self.held | {drive})

    def with_optional(self, place: int, width: int) -> "Widths":
        """Return these with another width of one optional friction of one drive."""
        return replace(self, optional=_with(self.optional, place, width))

    def optional_of(self, name: str) -> tuple[int, ...]:
        """Return the width of something of `OPTIONAL`, for each drive."""
        n = len(self.offset)
        return self.optional[n * OPTIONAL.index(name) :][:n]

    def _name(self, place: int) -> str:
        return OPTIONAL[place // len(self.offset)]

    def neighbours(self) -> tuple["Widths", ...]:
        """Return the widths one step away."""
        found = []
        for way in (1, -1):
            for other in (
                replace(self, figures=self.figures + way),
                replace(self, friction=self.friction + way),
                replace(self, stated_offset=self.stated_offset + way),
            ):
                if all(AS_STATED <= width <= WIDEST for width in other._of_what_is_stated()):
                    found.append(other)
        for i, width in enumerate(self.offset):
            for changed in (width + 1, width - 1):
                if self.least(i) <= changed <= 0 and i not in self.held:
                    found.append(replace(self, offset=_with(self.offset, i, changed)))
        return tuple(found)

    def lines(self) -> tuple[tuple["Widths", ...], ...]:
        """Return all values of each width with the others as they are: figures, friction, offsets, optional."""
        figures = tuple(replace(self, figures=k) for k in range(WIDEST + 1))
        friction = tuple(replace(self, friction=k) for k in range(WIDEST + 1))
        return figures, friction, *self.by_drive()

    def by_drive(self) -> tuple[tuple["Widths", ...], ...]:
        """Return all values of the width of each offset, then of what is optional, with the others as they are.

        An offset with nothing beyond what is stated has one width: where data do not tell it, what is stated does. So
        has what is `SELDOM` there, and is not.
        """
        drives = range(len(self.offset))
        unsure = [i for i in drives if i not in self.stated or self.offset[i] != NONE]
        offsets = (
            tuple(replace(self, offset=_with(self.offset, i, k)) for k in range(self.least(i), 1)) for i in unsure
        )
        there = (i for i, width in enumerate(self.optional) if width != NONE or self._name(i) not in SELDOM)
        optional = (tuple(self.with_optional(i, k) for k in range(NONE, 1)) for i in there)
        return *offsets, *optional

    def wider_than(self, other: "Widths") -> bool:
        """Return whether these allow for more."""
        return self._total() > other._total()

    def _total(self) -> int:
        return sum((*self._of_what_is_stated(), *self.offset, *self.optional))

    def _of_what_is_stated(self) -> tuple[int, int, int]:
        return self.figures, self.friction, self.stated_offset


def _with(values: tuple[int, ...], place: int, value: int) -> tuple[int, ...]:
    return (*values[:place], value, *values[place + 1 :])
