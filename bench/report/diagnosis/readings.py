"""What the models leave of every reading, in units of what cannot be predicted, and the circumstances of each."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.cross_validation.floor import floor_variance
from bench.diagnose.cross_validation.floor import measured as measured_at
from bench.diagnose.diagnose import Diagnosis
from bench.diagnose.extend.fit import pseudo_residual
from bench.diagnose.name.learned_shape import learned_of
from bench.diagnose.replay.instants import at_each_instant
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.world import World
from bench.predict.errors import rms
from bench.record.campaign import Array
from bench.report.diagnosis.recording_clock import recording_clock_of

STANDS_OUT = 1.2  # root mean square from where on a channel is worth a picture
Index = NDArray[np.int64]


@dataclass(frozen=True)
class Channel:
    """How well one channel is explained; residuals in units of what cannot be predicted.

    Attributes:
        channel: Column of the campaign.
        unit: SI.
        readings: How many were compared: means of repeats, and bins of motion.
        before: Root mean square without what was found, its other figures as fitted with it; 1 is what cannot be
            predicted.
        after: The same with what was found; None where nothing was.
    """

    channel: str
    unit: str
    readings: int
    before: float
    after: float | None


@dataclass(frozen=True, eq=False)
class Readings:
    """A campaign reading by reading; T instants, c quantities, n drives, m readings that were compared.

    What was found is compared with the nominal model under the same uncertain figures, those of the fit with what was
    found: the nominal model alone would bend them until little is left, and hide what is wrong.

    Attributes:
        quantities: What is compared.
        nominal: Shape (T, c), measured less what the nominal model says as it stands, nothing fitted; nan where not
            measured.
        left: Shape (T, c), measured less what the model with what was found says; where nothing was found, the nominal
            model with its uncertain figures fitted.
        noise: Shape (T, c), standard deviation of what cannot be predicted; nan where not measured.
        before: Shape (m,), residual without what was found; 1 is what cannot be predicted.
        after: Shape (m,), residual with it; None where nothing was found.
        measured: Shape (T, c); nan where not measured.
        simulated: Shape (T, c), without what was found.
        extended: Shape (T, c), with it; None where no model has it.
        instant: Shape (m,), index into the T instants.
        column: Shape (m,), index into the quantities.
        run: Shape (T,), index of the run among those that were compared.
        seconds: Shape (T,), runs one after another, as in the recording of the diagnosis.
        is_slide: Shape (n,), which drives slide.
        angle: Shape (T, n) [rad] or [m], of the motors.
        direction: Shape (T, n), sign of the velocity; 0 at rest.
    """

    quantities: tuple[Quantity, ...]
    nominal: Array
    left: Array
    noise: Array
    before: Array
    after: Array | None
    measured: Array
    simulated: Array
    extended: Array | None
    instant: Index
    column: Index
    run: Index
    seconds: Array
    is_slide: NDArray[np.bool_]
    angle: Array
    direction: Array

    @cached_property
    def channels(self) -> tuple[Channel, ...]:
        """Every channel with a reading, in the order of the campaign."""
        found = []
        for c, quantity in enumerate(self.quantities):
            mine = self.column == c
            if np.any(mine):
                after = None if self.after is None else rms(self.after[mine])
                found.append(Channel(quantity.column, quantity.unit, int(mine.sum()), rms(self.before[mine]), after))
        return tuple(found)

    def worst(self, count: int) -> tuple[int, ...]:
        """Return the indices of the channels that are explained worst without what was found, the worst first.

        At least one, and beyond that only channels that stand out.
        """
        size = {int(c): rms(self.before[self.column == c]) for c in np.unique(self.column)}
        ranked = sorted(size, key=lambda c: -size[c])[:count]
        return tuple(c for i, c in enumerate(ranked) if i == 0 or size[c] > STANDS_OUT)


@dataclass(frozen=True, eq=False)
class _Comparison:
    """Residuals and simulations of `Readings`, of the same names."""

    left: Array
    before: Array
    after: Array | None
    simulated: Array
    extended: Array | None


def readings_of(diagnosis: Diagnosis) -> Readings:
    """Return the readings of a diagnosis; a few simulations."""
    linear = diagnosis.linear
    segments = linear.segments
    measured = linear.observed
    found = _comparison(diagnosis, measured)
    moved = [np.sign(s.motion.velocity[s.motion.read]) * _moves(s) for s in segments]
    there = measured_at(linear)
    clock = recording_clock_of(linear)
    return Readings(
        quantities=linear.quantities,
        nominal=np.where(there, linear.residual, np.nan),
        left=np.where(there, found.left, np.nan),
        noise=np.sqrt(floor_variance(linear)),
        before=found.before,
        after=found.after,
        measured=measured,
        simulated=found.simulated,
        extended=found.extended,
        instant=linear.instant_of,
        column=linear.column_of.astype(np.int64),
        run=at_each_instant(segments, [linear.runs.index(s.run) for s in segments]),
        seconds=clock.seconds[~clock.is_break],
        is_slide=np.array(linear.replay.compiled.is_slide, dtype=bool),
        angle=np.concatenate([s.motion.q[s.motion.read] for s in segments]),
        direction=np.concatenate(moved),
    )


def _comparison(diagnosis: Diagnosis, measured: Array) -> _Comparison:
    linear, naming, unlisted = diagnosis.linear, diagnosis.naming, diagnosis.verdict.unlisted
    fit = diagnosis.extension or naming.null
    has_it = (diagnosis.discrepancy and diagnosis.discrepancy.is_gain) or (unlisted and unlisted.stand_ins)
    learned = None if has_it else learned_of(naming)
    change = np.zeros_like(measured)  # by the listed causes
    if fit.causes:
        world = fit.world(linear)
        change = linear.replay.predict(world) - linear.replay.predict(World(world.deviations))
    extended = measured - fit.residual
    left, shape = fit.residual, np.zeros(len(linear.white))
    if learned is not None and learned.stands_out:
        shape = learned.block.columns @ learned.value
        nuisances = linear.most_probable(pseudo_residual(linear, fit) - shape)
        left = left + linear.sensitivities @ (fit.nuisances - nuisances) - linear.unwhiten(shape[:, None])[:, :, 0]
    after = linear.whiten(left)
    before = after + shape + linear.whiten(change)
    is_found = bool(np.any(shape)) or bool(fit.causes)
    return _Comparison(
        left,
        before,
        after if is_found else None,
        extended - change,
        extended if fit.causes else None,
    )


def _moves(segment: Segment) -> NDArray[np.bool_]:
    """Return which drives move, shape (n,)."""
    moves: NDArray[np.bool_] = ~(np.asarray(segment.standing, dtype=bool) | segment.is_static)
    return moves
