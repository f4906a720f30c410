"""Which change is too large to be in proportion, and its sizes by simulation.

A payload that was taken off lets links rise, and what is bolted on elsewhere is felt at another point; what its
signature misses of that was named as small changes beside it. So each change of which enough is missed to be named as
something else is fitted by Gauss-Newton, with simulations in place of its signature and all that stayed integrated out.
The search begins anew about a machine in which the one acts that explains most (`large.py`).
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from bench.compare.background import Background
from bench.compare.large import LargeChange, all_acting, bounds_of
from bench.compare.search_changes import Found, Possible, sizes_of
from bench.compare.shared import undo_segments
from bench.diagnose.extend.steps import bounded_step, ever_shorter
from bench.diagnose.linearise.candidates import Candidate
from bench.diagnose.linearise.marginal import Columns
from bench.diagnose.replay.world import NOMINAL
from bench.errors import NOT_SIMULATED
from bench.record.campaign import Array

MOST_STEPS = 8  # effort: of Gauss-Newton
ENOUGH = 0.2  # effort: fall of the sum of squares, from where sizes are found


def found_large(background: Background, found: Found) -> LargeChange | None:
    """Return which change explains most of those of which signatures miss enough to be named as something else.

    Its sizes are found by simulation. None: signatures serve for all.
    """
    known = {one.cause.key for one in background.joint.large}
    fitted: list[tuple[float, LargeChange]] = []
    for term in found.alternatives[0].best.terms if found.shape is None else ():
        possible = found.possible[term]
        if possible.entry.cause is None or possible.entry.cause.key in known:
            continue
        mean, _ = sizes_of(found, (term,))
        change = large_change(background, possible, mean)
        missed, _ = departure(background, change, possible)
        if missed**2 / 2 > found.screened[0].threshold:
            with suppress(*NOT_SIMULATED):
                left, sizes = _Fit(background, possible, change).sizes()
                fitted.append((left, replace(change, sizes=sizes)))
    return min(fitted, key=lambda one: one[0])[1] if fitted else None


def large_change(background: Background, possible: Possible, sizes: Array) -> LargeChange:
    """Return a change with sizes in steps of its columns, shape (k,).

    A size that can have one sign only has that one, unless the model has some that may be gone.
    """
    candidate = possible.entry.what
    assert isinstance(candidate, Candidate)
    low, high = bounds_of(candidate.cause, background.joint.linear.replay.compiled)
    sizes = sizes * candidate.step
    sizes = np.clip(np.where(low < 0, sizes, np.abs(sizes)), low, high)
    return LargeChange(candidate.cause, dict(candidate.shape), sizes, possible.profile)


def departure(background: Background, change: LargeChange, possible: Possible) -> tuple[float, float]:
    """Return what signatures miss of a change, and its size by simulation, both in standard errors; nan: unknown.

    Args:
        background: All recordings.
        change: With the sizes of interest.
        possible: What it is in the search.
    """
    joint = background.joint
    others = [one for one in joint.large if one.cause.key != change.cause.key]
    same = [one for one in joint.large if one.cause.key == change.cause.key and one.shape == change.shape]
    recordings, replay = joint.recordings, joint.linear.replay
    try:
        beside = replay.predict(all_acting(others, recordings))
        simulated = replay.predict(all_acting([*others, change], recordings)) - beside
        about = replay.predict(all_acting([*others, *same], recordings)) - beside if same else np.zeros_like(beside)
    except NOT_SIMULATED:
        return np.nan, np.nan
    candidate = possible.entry.what
    assert isinstance(candidate, Candidate)
    further = (change.sizes - sum(one.sizes_as(change) for one in same)) / candidate.step
    rows = possible.profile.weights[joint.of_row]
    expected = rows * (background.columns[:, possible.entry.columns] @ further)
    white = _whitened(background, np.stack([simulated - about, simulated], axis=2))
    return float(np.linalg.norm(white[:, 0] - expected)), float(np.linalg.norm(white[:, 1]))


def _whitened(background: Background, changes: Array) -> Array:
    """Return changes of readings, shape (T, c, k), whitened instant by instant, shape (m, k)."""
    linear = background.joint.linear
    white = linear.whiten(changes)
    undo_segments(linear, white)
    return white


@dataclass(frozen=True, eq=False)
class _State:
    """Where a fit stands: sizes in steps, shape (k,), what instruments show, what is left, and its sum of squares."""

    x: Array
    shown: Array
    rest: Array
    left: float


class _Fit:
    """A change with sizes that leave least of the readings, all that stayed integrated out."""

    def __init__(self, background: Background, possible: Possible, change: LargeChange) -> None:
        candidate = possible.entry.what
        assert isinstance(candidate, Candidate)
        self._background, self._change = background, change
        self._unit, self._prior = candidate.step, possible.prior
        joint = background.joint
        self._replay, self._recordings = joint.linear.replay, joint.recordings
        read = joint.beyond + self._replay.predict(NOMINAL)
        self._whole = background.by_instant.residual + _whitened(background, read[:, :, None])[:, 0]
        ends = np.array(bounds_of(change.cause, self._replay.compiled)) / self._unit
        self._low, self._high = ends.min(axis=0), ends.max(axis=0)

    def sizes(self) -> tuple[float, Array]:
        """Return the sum of squares that is left, of readings and of sizes by their prior, and the sizes, shape (k,).

        Raises:
            ConvergenceError, RobotError: It is no machine.
        """
        state = self._at(np.clip(self._change.sizes / self._unit, self._low, self._high))
        for _ in range(MOST_STEPS):
            slopes = np.stack([self._shown(state.x + one) - state.shown for one in np.eye(len(state.x))], axis=2)
            white = self._background.whitening.of_instants(_whitened(self._background, slopes))
            marginal = self._background.nuisances.products(state.rest, Columns(white))
            curvature = marginal.information + np.diag(self._prior**-2.0)
            gradient = marginal.scores - state.x / self._prior**2
            limits = self._low - state.x, self._high - state.x
            step = bounded_step(curvature, gradient, *limits)
            before, state = state, self._better(state, ever_shorter(step, curvature, gradient, *limits))
            if before.left - state.left < ENOUGH:
                break
        return state.left, state.x * self._unit

    def _better(self, state: _State, steps: Iterator[Array]) -> _State:
        for step in steps:
            with suppress(*NOT_SIMULATED):
                then = self._at(state.x + step)
                if then.left < state.left:
                    return then
        return state

    def _shown(self, x: Array) -> Array:
        change = replace(self._change, sizes=x * self._unit)
        return self._replay.predict(all_acting([*self._background.joint.large, change], self._recordings))

    def _at(self, x: Array) -> _State:
        known, shown = self._background, self._shown(x)
        white = self._whole - _whitened(known, shown[:, :, None])[:, 0]
        rest = known.whitening.of_instants(white[:, None])[:, 0]
        misfit = known.nuisances.products(rest, np.empty((len(rest), 0))).misfit
        return _State(x, shown, rest, misfit + float(np.sum((x / self._prior) ** 2)))
