"""The shape that was learned where nothing listed explains the data: values, curves, and whether it is more than noise.

Verdict, table and picture all read it from here, so that they agree.
"""

from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.size import NORMAL_95
from bench.diagnose.linearise.generic import Block
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.name.discrepancy import OVER, Discrepancy
from bench.diagnose.name.naming import Naming
from bench.effects.learned_readings import (
    IN_ROOM,
    IN_TIME,
    NEAR_ZERO,
    OF_READING,
    UNDER_FORCE,
    in_time,
    of_reading,
    under_force,
)
from bench.record.campaign import Array

POINTS = 41  # effort: of a curve that is no table
FUNCTIONS = {"load": OF_READING, "place": IN_ROOM, "time": IN_TIME, "force": UNDER_FORCE}


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

    @property
    def stands_out(self) -> bool:
        """Whether its interval leaves out zero anywhere."""
        return any(low > 0 or high < 0 for low, high in zip(self.low, self.high, strict=True))


@dataclass(frozen=True, eq=False)
class LearnedShape:
    """A learned shape; k coefficients, m whitened readings.

    Attributes:
        block: The free shape; its columns have shape (m, k). Its unit is that of a turning drive.
        value: Shape (k,), in `unit`.
        covariance: Shape (k, k).
        slides: Whether it belongs to a drive that slides: N and m in place of Nm and rad.
        curves: Of it, empty where it depends on a place in the room.
    """

    block: Block
    value: Array
    covariance: Array
    slides: bool = False
    curves: tuple[LearnedCurve, ...] = ()

    @property
    def unit(self) -> str:
        """Unit of the coefficients."""
        return of_slide(self.block.unit) if self.slides else self.block.unit

    @property
    def over_unit(self) -> str:
        """Unit of the nodes."""
        unit = OVER[self.block.depends_on]
        return of_slide(unit) if self.slides else unit

    @property
    def half(self) -> Array:
        """Shape (k,), half of the 95 % intervals of the coefficients."""
        return NORMAL_95 * np.sqrt(np.diag(self.covariance))

    @property
    def names(self) -> tuple[tuple[str, str], ...]:
        """Name and words of each coefficient."""
        if len(self.block.nodes):
            return tuple((f"at_{i + 1}", f"at {x:.4g} {self.over_unit}") for i, x in enumerate(self.block.nodes))
        known = FUNCTIONS[self.block.depends_on]
        return tuple((known[i], known[i].replace("_", " ")) for i in self.block.functions)

    @property
    def stands_out(self) -> bool:
        """Whether the 95 % band of its curves, or of its coefficients where it has none, leaves out zero anywhere."""
        if self.curves:
            return any(curve.stands_out for curve in self.curves)
        return bool(np.any(np.abs(self.value) > self.half))

    @property
    def turns_round(self) -> bool:
        """Whether its sign turns round with the direction of motion."""
        if len(self.block.nodes) == 0:
            return False
        by_direction = self.block.depends_on in ("angle and direction", "speed")
        return by_direction or (self.block.depends_on == "load" and self.block.kind != "gear angle")


def of_slide(unit: str) -> str:
    """Return the unit that a quantity of a turning drive has on a sliding one: N for Nm, m for rad."""
    return unit.replace("Nm", "N").replace("rad", "m")


def learned_of(naming: Naming, discrepancy: Discrepancy | None = None) -> LearnedShape | None:
    """Return the shape that a naming calls unlisted, or None where it calls nothing so.

    Args:
        naming: What the data say.
        discrepancy: The shape as fitted by simulation; without it, or where no model has it, the linearised model says
            it.
    """
    block = naming.unlisted
    if block is None:
        return None
    slides = block.drive >= 0 and bool(naming.linear.replay.compiled.is_slide[block.drive])
    if discrepancy and discrepancy.fit and discrepancy.is_gain:
        shape = replace(_simulated(discrepancy, discrepancy.fit, block), slides=slides)
        return replace(shape, curves=curves_of(shape, discrepancy.linear))
    shape = LearnedShape(block, *naming.models[0].shape_estimate(naming.linear), slides)
    return replace(shape, curves=curves_of(shape, naming.linear))


def _simulated(discrepancy: Discrepancy, fit: Fit, block: Block) -> LearnedShape:
    cause = fit.causes[-1]
    mine = [i for i, unknown in enumerate(fit.unknowns) if unknown.cause is cause]
    columns = discrepancy.linear.whiten(fit.jacobian)[:, mine]
    nodes = getattr(cause.effect, "nodes", block.nodes)
    shape = replace(block, nodes=nodes, columns=columns)
    return LearnedShape(shape, fit.values[mine], fit.covariance[np.ix_(mine, mine)])


def curves_of(learned: LearnedShape, linear: LinearisedModel) -> tuple[LearnedCurve, ...]:
    """Return the curves of a learned shape; none where it depends on a place in the room."""
    block = learned.block
    if len(block.nodes):
        over, unit = block.depends_on, learned.over_unit
        return (_curve(learned, "", over, unit, block.nodes, np.eye(len(block.nodes))),)
    if block.depends_on == "load":
        share = np.unique(np.concatenate([np.linspace(-1, 1, POINTS), NEAR_ZERO]))
        basis = of_reading(share)[:, list(block.functions)]
        return (_curve(learned, "", "reading", learned.unit, share * block.size, basis),)
    if block.depends_on == "time":
        ends = [segment.motion.time for segment in (linear.segments[0], linear.segments[-1])]
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


def _curve(learned: LearnedShape, name: str, over: str, over_unit: str, at: Array, basis: Array) -> LearnedCurve:
    """Return a curve from the values of the k functions at n points, shape (n, k)."""
    value = basis @ learned.value
    half = NORMAL_95 * np.sqrt(np.einsum("nk,kl,nl->n", basis, learned.covariance, basis))
    columns = (tuple(float(x) for x in column) for column in (at, value, value - half, value + half))
    return LearnedCurve(name, over, over_unit, learned.unit, *columns)
