"""The shape that was learned where nothing listed explains the data: curves over what it depends on, with a band."""

from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.extend.fit import Fit
from bench.diagnose.name.learn import Lesson
from bench.diagnose.name.naming import Naming
from bench.diagnose.picture.design import Design
from bench.diagnose.picture.generic import Block
from bench.diagnose.verdict import NORMAL_95
from bench.effects.learned_readings import NEAR_ZERO, in_time, of_reading, under_force
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


def learned_of(naming: Naming, lesson: Lesson | None = None) -> Learned | None:
    """Return the shape that a naming calls unlisted, or None where it calls nothing so.

    Args:
        naming: What the data say.
        lesson: The shape as fitted by simulation; without it, or where no model has it, the linearised model says it.
    """
    block = naming.unlisted
    if block is None:
        return None
    if lesson and lesson.fit and lesson.pays:
        return _simulated(lesson, lesson.fit, block)
    return Learned(block, *naming.models[0].shape_estimate(naming.design))


def _simulated(lesson: Lesson, fit: Fit, block: Block) -> Learned:
    cause = fit.causes[-1]
    mine = [i for i, unknown in enumerate(fit.unknowns) if unknown.cause is cause]
    columns = lesson.design.whiten(fit.slopes)[:, mine]
    nodes = getattr(cause.effect, "nodes", block.nodes)
    shape = replace(block, nodes=nodes, columns=columns)
    return Learned(shape, fit.values[mine], fit.covariance[np.ix_(mine, mine)])


def curves_of(learned: Learned, design: Design) -> tuple[LearnedCurve, ...]:
    """Return the curves of a learned shape; none where it depends on a place in the room."""
    block = learned.block
    if len(block.nodes):
        unit = NODE_UNITS[block.depends_on]
        if design.replay.compiled.is_slide[block.drive]:
            unit = unit.replace("rad", "m").replace("Nm", "N")
        return (_curve(learned, "", block.depends_on, unit, block.nodes, np.eye(len(block.nodes))),)
    if block.depends_on == "load":
        share = np.unique(np.concatenate([np.linspace(-1, 1, POINTS), NEAR_ZERO]))
        basis = of_reading(share)[:, list(block.functions)]
        return (_curve(learned, "", "reading", block.unit, share * block.size, basis),)
    if block.depends_on == "time":
        ends = [segment.motion.time for segment in (design.segments[0], design.segments[-1])]
        hours = np.linspace(0.0, float(ends[1][-1] - ends[0][0]) / 3600, POINTS)
        found = []
        for axis, name in enumerate("xyz"):
            basis = in_time(hours)[:, axis, list(block.functions)]
            found.append(_curve(learned, name, "time", "h", hours, basis))
        return tuple(found)
    if block.depends_on == "force":
        share = np.linspace(0, 1, POINTS)
        basis = under_force(share)[:, :, list(block.functions)]
        force = share * block.size
        return tuple(_curve(learned, name, "force", "N", force, basis[:, axis]) for axis, name in enumerate("xyz"))
    return ()


def _curve(learned: Learned, name: str, over: str, over_unit: str, at: Array, basis: Array) -> LearnedCurve:
    """Return a curve from the values of the k functions at n points, shape (n, k)."""
    value = basis @ learned.value
    half = NORMAL_95 * np.sqrt(np.einsum("nk,kl,nl->n", basis, learned.covariance, basis))
    columns = (tuple(float(x) for x in column) for column in (at, value, value - half, value + half))
    return LearnedCurve(name, over, over_unit, learned.block.unit, *columns)
