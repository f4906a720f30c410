"""The shape that was learned where nothing listed explains the data: curves over what it depends on, with a band."""

from dataclasses import dataclass

import numpy as np

from bench.diagnose.design import Design
from bench.diagnose.generic import READING_SHARE, Block
from bench.diagnose.naming import Naming
from bench.diagnose.verdict import NORMAL_95
from bench.record.campaign import Array

POINTS = 41  # of a curve that is no table
NODE_UNITS = {"angle": "rad", "angle and direction": "rad", "speed": "rad/s", "load": "Nm"}


@dataclass(frozen=True, eq=False)
class Learned:
    """A learned shape; k coefficients, m whitened readings.

    Attributes:
        block: The free shape; its columns have shape (m, k).
        value: Shape (k,), in the unit of the block.
        covariance: Shape (k, k).
    """

    block: Block
    value: Array
    covariance: Array

    @property
    def turns_round(self) -> bool:
        """Whether its sign turns round with the direction of motion."""
        if len(self.block.nodes) == 0:
            return False
        by_direction = self.block.depends_on in ("angle and direction", "speed")
        return by_direction or (self.block.depends_on == "load" and self.block.kind != "gear angle")


@dataclass(frozen=True)
class LearnedCurve:
    """A learned shape as a curve of n points.

    Attributes:
        name: "" for a single one; the axis for several.
        over: What it depends on.
        over_unit: Unit of `at`.
        unit: Unit of the values.
        at: Where.
        value: Best value there.
        low, high: 95 % interval.
    """

    name: str
    over: str
    over_unit: str
    unit: str
    at: tuple[float, ...]
    value: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]


def learned_of(naming: Naming) -> Learned | None:
    """Return the shape that a naming calls unlisted, or None where it calls nothing so."""
    block = naming.unlisted
    if block is None:
        return None
    both = (naming.leftover, naming.screening) if naming.hypotheses else (naming.screening, naming.leftover)
    screening, entry = next((s, entry) for s in both for entry in s.entries if entry.what is block)
    return Learned(block, *screening.marginal.sizes(entry.columns, entry.prior))


def curves_of(learned: Learned, design: Design) -> tuple[LearnedCurve, ...]:
    """Return the curves of a learned shape; none where it depends on a place in the room."""
    block = learned.block
    if len(block.nodes):
        unit = NODE_UNITS[block.depends_on]
        if design.replay.compiled.is_slide[block.drive]:
            unit = unit.replace("rad", "m").replace("Nm", "N")
        return (_curve(learned, "", block.depends_on, unit, block.nodes, np.eye(len(block.nodes))),)
    if block.depends_on == "load" and len(learned.value) == 3:
        share = np.linspace(-1, 1, POINTS)
        powers = np.stack([share**2, share**3, np.abs(share) * share], axis=1)
        return (_curve(learned, "", "reading", block.unit, share * block.prior / READING_SHARE, powers),)
    if block.depends_on == "time" and len(learned.value) == 6:
        ends = [segment.motion.time for segment in (design.segments[0], design.segments[-1])]
        hours = np.linspace(0.0, float(ends[1][-1] - ends[0][0]) / 3600, POINTS)
        found = []
        for axis, name in enumerate("xyz"):
            powers = np.zeros((POINTS, 6))
            powers[:, axis], powers[:, 3 + axis] = hours, hours**2
            found.append(_curve(learned, name, "time", "h", hours, powers))
        return tuple(found)
    return ()


def _curve(learned: Learned, name: str, over: str, over_unit: str, at: Array, basis: Array) -> LearnedCurve:
    """Return a curve from the values of the k functions at n points, shape (n, k)."""
    value = basis @ learned.value
    half = NORMAL_95 * np.sqrt(np.einsum("nk,kl,nl->n", basis, learned.covariance, basis))
    columns = (tuple(float(x) for x in column) for column in (at, value, value - half, value + half))
    return LearnedCurve(name, over, over_unit, learned.block.unit, *columns)
