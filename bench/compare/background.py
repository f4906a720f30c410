"""Everything that stayed as it was: what may be off, and the machine's discrepancy, to be integrated out."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.compare.coincidence import cells_of, is_one_program
from bench.compare.joint import Joint
from bench.compare.levels import by_level
from bench.compare.noise import Repeatability, repeatability_of
from bench.compare.shared import SharedWhitening, shared_whitening
from bench.diagnose.linearise.linearised_model import raised, with_held
from bench.diagnose.linearise.marginal import Nuisances
from bench.diagnose.linearise.screening import Entry, tried_of
from bench.errors import InputError
from bench.record.campaign import Array

# Shares of the scatter of friction at rest, as standard deviations, that are tried beside all of it; 0.04 of it is less
# than instruments see. A coarse grid: what is left between two of them `noise.py` finds in the differences.
HELD = (0.2, 0.04)


@dataclass(frozen=True, eq=False)
class Background:
    """All recordings with everything that stayed as it was; m whitened readings, q columns.

    Attributes:
        joint: The recordings, with standard errors raised by what is new in each.
        white: Shape (m,), residual of the nominal model.
        entries: Every cause and every free shape, each with its columns.
        columns: Shape (m, q), what they change if they act in all recordings alike, before `whitening`.
        whitening: In which what repeats is no news.
        nuisances: What may be off, the machine's and each recording's, and the discrepancy.
        repeatability: How well readings repeat.
        cells: Shape (T,), the state of every instant.
    """

    joint: Joint
    white: Array
    entries: tuple[Entry, ...]
    columns: Array
    whitening: SharedWhitening
    nuisances: Nuisances
    repeatability: Repeatability
    cells: NDArray[np.intp]

    def acting(self, columns: Array | NDArray[np.signedinteger], weights: Array) -> Array:
        """Return what some columns change, shape (m, k), with a share, shape (K,), of their size in each recording."""
        return self.whitening(self.columns[:, columns] * weights[self.joint.of_row][:, None])

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
    probable (REML), taken for unchanged. It depends on all that was done before, so that is asked only
    where all recordings run one program; otherwise all of it counts.

    Raises:
        InputError: Nothing of the catalogue would leave a trace.
    """
    cells = cells_of(joint.linear.segments, joint.of_segment)
    plain = _background(joint, cells)
    if not is_one_program(joint.linear.segments, joint.of_segment):
        return plain
    found, best = plain, _log_evidence(plain)
    for held in HELD:
        other = _background(replace(joint, linear=with_held(joint.linear, held)), cells)
        evidence = _log_evidence(other)
        if evidence < best:
            break
        found, best = other, evidence
    return found


def raised_background(background: Background, factors: Array) -> Background:
    """Return the background with more of what is new in each recording.

    Args:
        background: So far.
        factors: Shape (2, c), of the variance, for every quantity at rest and in motion.
    """
    known = background.repeatability
    repeatability = replace(known, own=known.own * factors)
    linear = raised(background.joint.linear, np.sqrt(factors))
    return _assembled(replace(background.joint, linear=linear), repeatability, background.cells)


def _background(joint: Joint, cells: NDArray[np.intp]) -> Background:
    """Return all recordings with the share of friction at rest that their linearised model counts."""
    repeatability = _repeatability(joint, cells)
    linear = raised(joint.linear, np.sqrt(repeatability.own))
    return _assembled(replace(joint, linear=linear), repeatability, cells)


def _assembled(joint: Joint, repeatability: Repeatability, cells: NDArray[np.intp]) -> Background:
    """Return all recordings with standard errors that count what is new in each of them."""
    linear = joint.linear
    tried = tried_of(joint.tried())
    whitening = shared_whitening(linear, repeatability, cells)
    slopes = by_level(linear.jacobian, linear.nuisances, joint.of_row, linear.held)
    discrepancy = tried.columns.matrix * tried.prior
    every = whitening(np.concatenate([slopes, discrepancy, linear.white[:, None]], axis=1))
    nuisances = Nuisances(every[:, : slopes.shape[1]], every[:, slopes.shape[1] : -1])
    columns = tried.columns.matrix
    return Background(joint, every[:, -1], tried.entries, columns, whitening, nuisances, repeatability, cells)


def _log_evidence(background: Background) -> float:
    """Return the log evidence of the readings of a machine that stayed as it was."""
    known = background.nuisances
    misfit = known.products(background.white, np.empty((len(background.white), 0))).misfit
    return background.whitening.log_determinant - known.log_determinant - 0.5 * misfit


def _repeatability(joint: Joint, cells: NDArray[np.intp]) -> Repeatability:
    what = joint.tried()
    if not what:
        raise InputError(
            "nothing of the catalogue would leave a trace in these recordings: log motor currents or torques, a "
            "reflector, a link encoder, or the gas pressure, beside the motor angles."
        )
    tried = tried_of(what)
    linear = joint.linear
    slopes = by_level(linear.jacobian, linear.nuisances, joint.of_row, linear.held)
    return repeatability_of(joint, slopes, tried.columns.matrix * tried.prior, cells)
