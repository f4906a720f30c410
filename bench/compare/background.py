"""Everything that stayed as it was: what may be off, and the machine's discrepancy, to be integrated out."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.compare.coincidence import cells_of, is_one_program
from bench.compare.joint import Joint
from bench.compare.levels import Slopes, by_level
from bench.compare.noise import Repeatability, repeatability_of
from bench.compare.shared import SharedWhitening, shared_whitening, undo_segments
from bench.diagnose.linearise.candidates import Candidate
from bench.diagnose.linearise.generic import Block
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.marginal import AT_A_TIME, Nuisances
from bench.diagnose.linearise.other_noise import raised, with_scatter
from bench.diagnose.linearise.screening import Entry, Tried, tried_of
from bench.errors import InputError
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
        joint: The recordings, with standard errors raised by what is new in each.
        white: Shape (m,), residual of the nominal model.
        plain: Shape (m,), the same whitened instant by instant.
        entries: Every cause and every free shape, each with its columns.
        columns: Shape (m, q), what they change if they act in all recordings alike, whitened instant by instant.
        prior: Shape (q,), standard deviations of their sizes.
        discrepancy: Shape (m, d), what they change where they stayed, whitened instant by instant: the same array
            without a large change.
        discrepancy_prior: Shape (d,), standard deviations of these sizes.
        slopes: Of what may be off, the machine's and each recording's, whitened instant by instant.
        whitening: In which what repeats is no news.
        nuisances: What may be off, the machine's and each recording's, and the discrepancy.
        repeatability: How well readings repeat.
        cells: Shape (T,), the state of every instant.
    """

    joint: Joint
    white: Array
    plain: Array
    entries: tuple[Entry, ...]
    columns: Array
    prior: Array
    discrepancy: Array
    discrepancy_prior: Array
    slopes: Slopes
    whitening: SharedWhitening
    nuisances: Nuisances
    repeatability: Repeatability
    cells: NDArray[np.intp]

    def acting(self, columns: Array | NDArray[np.signedinteger], weights: Array) -> Array:
        """Return what some columns change, shape (m, k), with a share, shape (K,), of their size in each recording."""
        return self.whitening.of_instants(self.columns[:, columns] * weights[self.joint.of_row][:, None])

    @property
    def coinciding(self) -> Array:
        """Shape (K,), share of each recording's instants whose state was met in another recording too."""
        count = np.bincount(self.cells, minlength=len(self.cells))[self.cells]
        of = self.joint.of_instant
        return np.array([np.mean(count[of == k] > 1) for k in range(len(self.joint.recordings))])


def background_of(joint: Joint) -> Background:
    """Return all recordings with everything that stayed as it was.

    The discrepancy is every cause of the catalogue with its plausible sizes, and every free shape, acting in all
    recordings alike. How much of the friction at rest is new in each recording is what the recordings find most
    probable (REML), taken for unchanged. It depends on all that was done before, so that is asked only where all
    recordings run one program; otherwise all of it counts.

    Raises:
        InputError: Nothing of the catalogue would leave a trace.
    """
    cells = cells_of(joint.linear.segments, joint.of_segment)
    found = _first(joint, cells)
    if not is_one_program(joint.linear.segments, joint.of_segment):
        return found
    other = _first(replace(joint, linear=with_scatter(joint.linear, replace(joint.linear.scatter, new=HELD))), cells)
    return max(found, other, key=_log_evidence)


def _first(joint: Joint, cells: NDArray[np.intp]) -> Background:
    """Return the background with noise that counts what not even everything together explains.

    Each recording is fitted by itself with all that could be added to its model, so no change counts as noise.
    """
    known = Repeatability.of_instruments(len(joint.linear.quantities))
    for _ in range(ROUNDS):
        before = known
        known = repeatability_of(joint.linear, *_left_of_each(joint), cells, before)
        joint = replace(joint, linear=raised(joint.linear, np.sqrt(known.own / before.own)))
        if _is_settled(before, known):
            break
    return assembled(joint, known, cells)


def _left_of_each(joint: Joint) -> tuple[Array, Array]:
    """Return what everything together leaves of each recording by itself, and the degrees of freedom of that.

    Returns:
        Shape (m,) each, whitened instant by instant.
    """
    linear, of_row = joint.linear, joint.of_row
    discrepancy = _tried(joint.discrepancy())
    slopes = by_level(linear.jacobian, linear.nuisances, of_row, linear.scatter.new).matrix
    left, free, variance = np.empty(len(linear.white)), np.empty(len(linear.white)), _variances(linear)
    for k in range(len(joint.recordings)):  # which stand one after the other
        rows = slice(*np.searchsorted(of_row, (k, k + 1)).tolist())
        every = np.concatenate([slopes[rows], discrepancy.columns.matrix[rows] * discrepancy.prior], axis=1)
        fitted = Nuisances(every)
        left[rows] = linear.white[rows] - every @ fitted.most_probable(linear.white[rows])
        undo_segments(linear, every, rows.start)
        free[rows] = variance[rows] - fitted.variances(every)
    undo_segments(linear, left[:, None])
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


def settled_background(background: Background, changes: Array) -> Background:
    """Return the background with noise that counts all that some changes leave of the readings.

    Args:
        background: So far.
        changes: Shape (m, k), what they change, whitened instant by instant, each with a prior of one.
    """
    for _ in range(ROUNDS):
        before = background.repeatability
        after = repeatability_of(background.joint.linear, *_left(background, changes), background.cells, before)
        factors = after.own / before.own
        if _is_settled(before, after):
            break
        linear = raised(background.joint.linear, np.sqrt(factors))
        background = assembled(replace(background.joint, linear=linear), after, background.cells)
        changes = changes / np.sqrt(factors)[linear.kind_of, linear.column_of][:, None]
    return background


def _left(background: Background, changes: Array) -> tuple[Array, Array]:
    """Return what the model leaves of the readings, and the degrees of freedom of that, but for the few of the changes.

    Returns:
        Shape (m,) each, whitened instant by instant.
    """
    known = background.nuisances
    white = background.whitening.of_instants(changes)
    found, k = known.products(background.white, white), white.shape[1]
    sizes = np.linalg.solve(found.information + np.eye(k), found.scores)
    rest = known.most_probable(background.white - white @ sizes)
    slopes = background.slopes.matrix
    left, free = background.plain - changes @ sizes, _variances(background.joint.linear)
    for start in range(0, len(left), AT_A_TIME):  # all of them take hundreds of megabytes
        rows = slice(start, start + AT_A_TIME)
        stayed = background.discrepancy[rows] * background.discrepancy_prior
        every = np.concatenate([slopes[rows], stayed], axis=1)
        left[rows] -= every @ rest
        free[rows] -= known.variances(every)
    return left, np.maximum(free, 0.0)


def _tried(what: tuple[Candidate | Block, ...]) -> Tried:
    """Return everything that may act.

    Raises:
        InputError: There is nothing.
    """
    if not what:
        raise InputError(
            "nothing of the catalogue would leave a trace in these recordings: log motor currents or torques, a "
            "reflector, a link encoder, or the gas pressure, beside the motor angles."
        )
    return tried_of(what)


def assembled(joint: Joint, repeatability: Repeatability, cells: NDArray[np.intp]) -> Background:
    """Return all recordings with standard errors that count what is new in each of them."""
    linear, tried = joint.linear, _tried(joint.tried())
    whitening = shared_whitening(linear, repeatability, cells)
    slopes = by_level(linear.jacobian, linear.nuisances, joint.of_row, linear.scatter.new)
    columns, plain = tried.columns.matrix, linear.white[:, None].copy()
    stayed = _tried(joint.discrepancy()) if joint.large else tried
    discrepancy = stayed.columns.matrix
    for values in (slopes.matrix, columns, plain, *([discrepancy] if discrepancy is not columns else [])):
        undo_segments(linear, values)
    m, p = slopes.matrix.shape
    every = np.empty((m, p + discrepancy.shape[1]))  # of hundreds of megabytes each: few copies
    every[:, :p] = slopes.matrix
    np.multiply(discrepancy, stayed.prior, out=every[:, p:])
    every, white = whitening.of_instants(every), whitening.of_instants(plain)[:, 0]
    return Background(
        joint=joint,
        white=white,
        plain=plain[:, 0],
        entries=tried.entries,
        columns=columns,
        prior=tried.prior,
        discrepancy=discrepancy,
        discrepancy_prior=stayed.prior,
        slopes=slopes,
        whitening=whitening,
        nuisances=Nuisances(every),
        repeatability=repeatability,
        cells=cells,
    )


def _log_evidence(background: Background) -> float:
    """Return the log evidence of the readings of a machine that stayed as it was."""
    known = background.nuisances
    misfit = known.products(background.white, np.empty((len(background.white), 0))).misfit
    return background.whitening.log_determinant - known.log_determinant - 0.5 * misfit
