"""Readings at rest that do not go with the loads: sorted, shuffled, of other rows.

Within a visit to a pose nothing but the load changes. So what a reflector or a drive does there is linear in the loads
as stated, whatever the stiffness of the robot, but for noise and friction. What changes as far as by the nominal model,
where that is more than these make, and not with the loads, is not in the rows of its loads.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.plausibility.mistaken import doubt
from bench.diagnose.plausibility.physical_fit import HALF
from bench.diagnose.plausibility.repeated import Repeated
from bench.diagnose.plausibility.unstated_loads import held_at_rest
from bench.diagnose.replay.noise import Noise
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.static_segments import visits_of
from bench.diagnose.replay.world import NOMINAL
from bench.record.campaign import Array, Run
from bench.record.finding import Finding
from bench.record.rules.sheet import LOAD_N

# declared: times the noise of a reflector, that the model has it move at least: noise is then a hundredth of a change
CLEAR = 10.0
MORE = 2  # exact: states of a visit, beyond the directions of its loads, for a mean and something to be left


@dataclass(frozen=True, eq=False)
class _Visit:
    """The rows of a visit in which loads change; n rows, c quantities.

    Attributes:
        run: Of which.
        rows: Shape (n,), in its table.
        directions: Shape (n, r), orthonormal, in which loads change.
        model: Shape (n, c), what the nominal model has.
    """

    run: Run
    rows: NDArray[np.intp]
    directions: Array
    model: Array


@dataclass
class _Change:
    """What a channel does within visits, squares summed over rows.

    Attributes:
        rows: How many.
        seen: Of what was read.
        left: Of what the loads leave of it, for as many degrees of freedom.
        model: Of the nominal model.
        least: Of what noise or friction make.
    """

    rows: int = 0
    seen: float = 0.0
    left: float = 0.0
    model: float = 0.0
    least: float = 0.0

    @property
    def is_elsewhere(self) -> bool:
        """Whether it is as large as the model has it, and not with the loads."""
        is_clear = self.model > self.least and self.seen > HALF**2 * self.model
        return is_clear and self.left > HALF * self.seen

    def count(self, visit: _Visit, values: Array, model: Array, least: Array) -> None:
        """Add what a visit shows, shape (n,) each: readings, those of the model, and from where on they are clear."""
        n, r = visit.directions.shape
        seen = values - values.mean()
        left = seen - visit.directions @ (visit.directions.T @ seen)
        self.rows += n
        self.seen += float(seen @ seen)
        self.left += float(left @ left) * (n - 1) / (n - 1 - r)
        self.model += float(np.sum((model - model.mean()) ** 2))
        self.least += float(least @ least)


def not_with_the_loads(repeated: Repeated) -> Iterator[Finding]:
    """Yield a doubt for each channel that at rest changes as far as loads make it, and not with them.

    Args:
        repeated: The campaign.
    """
    replays = [repeated.by_drives] if repeated.paid else []
    replays += [repeated.by_others] if repeated.seen else []
    for replay in replays:
        for quantity, change in _changes(repeated, replay).items():
            if change.is_elsewhere:
                size, share = (change.seen / change.rows) ** 0.5, 1 - change.left / change.seen
                what = f"at rest changes by {size:.2g} {quantity.unit} within visits, as far as loads move it"
                message = f"{what}, but not with them: the loads as stated explain {max(share, 0):.0%} of it"
                yield doubt(quantity.column, message, "sorted, shuffled, or joined to other rows? loads likewise")


def _changes(repeated: Repeated, replay: Replay) -> dict[Quantity, _Change]:
    """Return what reflectors and drives do within visits in which loads change."""
    noise = Noise(repeated.campaign, repeated.compiled.robot.figures)
    found: dict[Quantity, _Change] = {}
    for visit in _visits(repeated, replay):
        for c, quantity in enumerate(replay.quantities):
            values = visit.run.columns.get(quantity.column, np.full(1, np.nan))
            if (quantity.is_drive or quantity.kind == "reflector") and np.isfinite(values).all():
                values = values[visit.rows]
                least = _least(repeated, quantity, noise.of(quantity, values, visit.run))
                found.setdefault(quantity, _Change()).count(visit, values, visit.model[:, c], least)
    return found


def _visits(repeated: Repeated, replay: Replay) -> Iterator[_Visit]:
    """Yield the visits in which loads change, and in which more states were read than a line through them takes."""
    runs = {run.name: run for run in repeated.campaign.of_kind("static")}
    inputs = {(name, one.label): one for name, run in runs.items() for one in visits_of(run, repeated.compiled)}
    parts = np.split(replay.predict(NOMINAL), np.cumsum([len(segment) for segment in replay.segments])[:-1])
    for segment, predicted in zip(replay.segments, parts, strict=True):
        known = inputs.get((segment.run, segment.label))
        loads = segment.motion.wrench[segment.motion.read]
        if known is None or len(known.groups) != len(segment) or np.max(np.ptp(loads, axis=0)) <= LOAD_N:
            continue
        state = np.repeat(np.arange(len(segment)), [len(group) for group in known.groups])
        directions = _directions(loads[state])
        if len(segment) >= directions.shape[1] + MORE:
            yield _Visit(runs[segment.run], np.concatenate(known.groups), directions, predicted[state])


def _least(repeated: Repeated, quantity: Quantity, noise: Array) -> Array:
    """Return from which size on a change is told from noise and friction, shape (n,).

    A drive that holds anything up to h pays h / sqrt(3) more or less: a quarter of what changes, where loads make h.
    """
    if quantity.is_drive:
        constant = abs(repeated.compiled.torque_constant[quantity.index])
        held = held_at_rest(repeated.compiled, quantity.index)
        return np.full_like(noise, held / constant if quantity.kind == "current" else held)
    return CLEAR * noise


def _directions(loads: Array) -> Array:
    """Return the directions in which loads change over some rows, orthonormal, shape (n, r).

    Args:
        loads: Shape (n, 6).
    """
    change = loads - loads.mean(axis=0)
    left, sizes, _ = np.linalg.svd(change, full_matrices=False)
    return left[:, sizes > LOAD_N]
