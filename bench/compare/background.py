"""Everything that stayed as it was: what may be off, and the machine's discrepancy, to be integrated out."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.compare.by_instant import ByInstant
from bench.compare.coincidence import cells_of, is_one_program
from bench.compare.joint import Joint
from bench.compare.levels import Slopes
from bench.compare.noise import Repeatability, repeatability_of
from bench.compare.shared import SharedWhitening, settle_segments, shared_whitening, undo_segments
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.marginal import AT_A_TIME, Nuisances
from bench.diagnose.linearise.other_noise import raised, with_scatter
from bench.diagnose.linearise.screening import Entry
from bench.executor.watched import Check, never
from bench.record.campaign import Array

# rounding: share of the scatter of friction at rest, as a standard deviation, that is tried beside all of it. That is
# less than currents resolve, so where rests repeat it stands for none; what lies between shows in differences
# (`noise.py`).
HELD = 0.04
ENOUGH = 0.4  # effort: log of a variance; a lesser change is settled (1.2 in the standard error, as in a diagnosis)
ROUNDS = 2  # effort: of estimating them


@dataclass(frozen=True, eq=False)
class Background:
    """All recordings with everything that stayed as it was; m whitened readings, q columns.

    Attributes:
        by_instant: The recordings and what may act in them, with standard errors raised by what is new in each.
        white: Shape (m,), residual of the nominal model.
        whitening: In which what repeats is no news.
        nuisances: What may be off, the machine's and each recording's, and the discrepancy.
        repeatability: How well readings repeat.
        cells: Shape (T,), the state of every instant.
    """

    by_instant: ByInstant
    white: Array
    whitening: SharedWhitening
    nuisances: Nuisances
    repeatability: Repeatability
    cells: NDArray[np.intp]

    @property
    def joint(self) -> Joint:
        """The recordings, with standard errors raised by what is new in each."""
        return self.by_instant.joint

    @property
    def entries(self) -> tuple[Entry, ...]:
        """Every cause and every free shape, each with its columns."""
        return self.by_instant.entries

    @property
    def columns(self) -> Array:
        """Shape (m, q), what they change if they act in all recordings alike, whitened instant by instant."""
        return self.by_instant.columns

    @property
    def slopes(self) -> Slopes:
        """Of what may be off, the machine's and each recording's, whitened instant by instant."""
        return self.by_instant.slopes

    def acting(self, columns: Array | NDArray[np.signedinteger], weights: Array) -> Array:
        """Return what some columns change, shape (m, k), with a share, shape (K,), of their size in each recording."""
        return self.whitening.of_instants(self.columns[:, columns] * weights[self.joint.of_row][:, None])

    @property
    def coinciding(self) -> Array:
        """Shape (K,), share of each recording's instants whose state was met in another recording too."""
        count = np.bincount(self.cells, minlength=len(self.cells))[self.cells]
        of = self.joint.of_instant
        return np.array([np.mean(count[of == k] > 1) for k in range(len(self.joint.recordings))])


def background_of(joint: Joint, check: Check = never) -> Background:
    """Return all recordings with everything that stayed as it was.

    The discrepancy is every cause of the catalogue with its plausible sizes, and every free shape, acting in all
    recordings alike. How much of the friction at rest is new in each recording is what the recordings find most
    probable (REML), taken for unchanged. It depends on all that was done before, so that is asked only where all
    recordings run one program; otherwise all of it counts.

    Args:
        joint: All recordings.
        check: Called between steps; what it raises ends it.

    Raises:
        InputError: Nothing of the catalogue would leave a trace.
    """
    cells, as_stated = cells_of(joint.linear.segments, joint.of_segment), ByInstant.of(joint)
    found = _first(as_stated, cells, check)
    if not is_one_program(joint.linear.segments, joint.of_segment):
        return found
    held = with_scatter(joint.linear, replace(joint.linear.scatter, new=HELD))
    return max(found, _first(as_stated.again(held), cells, check), key=_log_evidence)


def _first(by_instant: ByInstant, cells: NDArray[np.intp], check: Check) -> Background:
    """Return the background with noise that counts what not even everything together explains.

    Each recording is fitted by itself with all that could be added to its model, so no change counts as noise.
    """
    known = Repeatability.of_instruments(len(by_instant.joint.linear.quantities))
    for _ in range(ROUNDS):
        check()
        before, linear = known, by_instant.joint.linear
        known = repeatability_of(linear, *_left_of_each(by_instant), cells, before)
        by_instant = by_instant.again(raised(linear, np.sqrt(known.own / before.own)))
        if _is_settled(before, known):
            break
    check()
    return assembled(by_instant, known, cells)


def _left_of_each(by_instant: ByInstant) -> tuple[Array, Array]:
    """Return what everything together leaves of each recording by itself, and the degrees of freedom of that.

    Returns:
        Shape (m,) each, whitened instant by instant.
    """
    joint = by_instant.joint
    linear, left = joint.linear, by_instant.residual.copy()
    free = _variances(linear)
    for k in range(len(joint.recordings)):  # which stand one after the other
        rows = slice(*np.searchsorted(joint.of_row, (k, k + 1)).tolist())
        every = by_instant.stayed(rows)
        settle_segments(linear, every, rows.start)
        fitted = Nuisances(every)
        sizes = fitted.most_probable(linear.white[rows])
        undo_segments(linear, every, rows.start)
        left[rows] -= every @ sizes
        free[rows] -= fitted.variances(every)
    return left, np.maximum(free, 0.0)


def _variances(linear: LinearisedModel) -> Array:
    """Return the variances of readings that were whitened instant by instant, shape (m,): one, and what is common."""
    return np.concatenate([1 + np.sum(one.common**2, axis=1) for one in linear.whitenings])


def _is_settled(before: Repeatability, after: Repeatability) -> bool:
    """Whether noise is as it was, as far as matters."""
    return bool(
        np.all(np.abs(np.log(after.own / before.own)) < ENOUGH)
        and np.all(np.abs(after.shared - before.shared) < ENOUGH * after.own)
    )


def settled_background(
    background: Background, changes: Callable[[Background], Array], check: Check = never
) -> Background:
    """Return the background with noise that counts all that some changes leave of the readings.

    Args:
        background: So far.
        changes: Of a background, what they change, shape (m, k), whitened instant by instant, each with a prior of one.
        check: Called between steps; what it raises ends it.
    """
    for _ in range(ROUNDS):
        check()
        before, linear = background.repeatability, background.joint.linear
        after = repeatability_of(linear, *_left(background, changes(background)), background.cells, before)
        if _is_settled(before, after):
            break
        again = background.by_instant.again(raised(linear, np.sqrt(after.own / before.own)))
        background = assembled(again, after, background.cells)
    return background


def _left(background: Background, changes: Array) -> tuple[Array, Array]:
    """Return what the model leaves of the readings, and the degrees of freedom of that, but for the few of the changes.

    Returns:
        Shape (m,) each, whitened instant by instant.
    """
    known, by_instant = background.nuisances, background.by_instant
    white = background.whitening.of_instants(changes)
    found, k = known.products(background.white, white), white.shape[1]
    sizes = np.linalg.solve(found.information + np.eye(k), found.scores)
    rest = known.most_probable(background.white - white @ sizes)
    left, free = by_instant.residual - changes @ sizes, _variances(background.joint.linear)
    for start in range(0, len(left), AT_A_TIME):  # all of them take hundreds of megabytes
        rows = slice(start, start + AT_A_TIME)
        every = by_instant.stayed(rows)
        left[rows] -= every @ rest
        free[rows] -= known.variances(every)
    return left, np.maximum(free, 0.0)


def assembled(by_instant: ByInstant, repeatability: Repeatability, cells: NDArray[np.intp]) -> Background:
    """Return all recordings with standard errors that count what is new in each of them."""
    whitening = shared_whitening(by_instant.joint.linear, repeatability, cells)
    every = whitening.of_instants(by_instant.stayed(slice(None)))
    white = whitening.of_instants(by_instant.residual[:, None])[:, 0]
    return Background(by_instant, white, whitening, Nuisances(every), repeatability, cells)


def _log_evidence(background: Background) -> float:
    """Return the log evidence of the readings of a machine that stayed as it was."""
    known = background.nuisances
    misfit = known.products(background.white, np.empty((len(background.white), 0))).misfit
    return background.whitening.log_determinant - known.log_determinant - 0.5 * misfit
