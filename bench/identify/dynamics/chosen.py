"""Solve: with the delay and the widths of the prior that held-out errors choose."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.identify.dynamics.band import Band
from bench.identify.dynamics.equations import OPTIONAL
from bench.identify.dynamics.folds import Folds
from bench.identify.dynamics.held_out import Missed, missed
from bench.identify.dynamics.normal import log_evidence
from bench.identify.dynamics.prior import NARROWEST, NONE, Prior, Widths
from bench.identify.dynamics.rows import DriveRows
from bench.identify.dynamics.solve import Solution, solve

# declared: log evidence from where on a drive has it; 100 to 1, as a diagnosis asks of a finding
WANTED = {"viscous_difference": 0.0, "rolling": float(np.log(100.0))}
ROUNDS = 2  # effort: of asking by how much the model errs beside its data; a third changes a tenth of that


def with_its_delay(
    rows: Sequence[DriveRows], prior: Prior, band: Band, folds: Folds, *, find_delay: bool
) -> tuple[Solution, Missed]:
    """Return the posterior, with a delay where that surely predicts what was held out better, and what it misses.

    Where it does not, the solution says which one a fit with one has.
    """
    solution, at_once = _solved(rows, prior, band, folds, find_delay=False)
    if find_delay:
        late, later = _solved(rows, prior, band, folds, find_delay=True)
        if later.surely_less_than(at_once):
            return late, later
        solution = replace(solution, not_taken=(late.delay, late.delay_sigma))
    return solution, at_once


def _solved(
    rows: Sequence[DriveRows], prior: Prior, band: Band, folds: Folds, find_delay: bool
) -> tuple[Solution, Missed]:
    """Return the posterior whose noise is what is missed beside its data, and that."""
    inflation = np.ones(len(rows))
    for _ in range(ROUNDS):
        beside = missed(solve(rows, prior, band.cutoff_hz, inflation, find_delay), prior, folds)
        inflation = inflation * beside.excess
    solution = solve(rows, prior, band.cutoff_hz, inflation, find_delay)
    beside = missed(solution, prior, folds)
    widths = _held_out_widths(solution, beside, prior, folds)
    if widths != solution.widths:
        solution = solve(rows, prior, band.cutoff_hz, inflation, find_delay, widths)
        beside = missed(solution, prior, folds)
    return solution, beside


def _held_out_widths(solution: Solution, beside: Missed, prior: Prior, folds: Folds) -> Widths:
    """Return the widths with those that held-out errors choose: what is not needed to predict is left out.

    Scales of torques stay as read where all drives together are predicted no worse so, each by the logarithm of its
    error, and where what is held out repeats the rest, which is no test of them. An offset is held where its drive's
    torque is predicted no worse without it. Optional friction (viscous that differs between the directions, rolling) is
    there where the evidence wants it and the drive is predicted better: it bends in what a model misses. Rolling
    friction is much like Coulomb and viscous friction together, so chance has it in their place unless the evidence
    wants it for sure.
    """
    as_read = replace(solution, widths=replace(solution.widths, scale=NARROWEST))
    tried = missed(as_read, prior, folds)
    if folds.repeats or tried.misfit <= beside.misfit:
        solution, beside = as_read, tried
    for drive, width in enumerate(solution.widths.offset):
        if width == solution.widths.least(drive) or solution.noise[drive] is None:
            continue
        without = replace(solution, widths=solution.widths.holding(drive))
        tried = missed(without, prior, folds)
        if tried.squares[:, drive].sum() <= beside.squares[:, drive].sum():
            solution, beside = without, tried
    for place in range(len(solution.widths.optional)):
        drive = place % len(solution.noise)
        if solution.noise[drive] is None:
            continue
        line = [solution.widths.with_optional(place, width) for width in range(NONE, 1)]
        evidence = [log_evidence(solution.normal, prior, widths) for widths in line]
        best = line[int(np.argmax(evidence))]
        if max(evidence) - evidence[0] <= WANTED[OPTIONAL[place // len(solution.noise)]]:
            continue
        more = replace(solution, widths=best)
        tried = missed(more, prior, folds)
        if tried.squares[:, drive].sum() < beside.squares[:, drive].sum():
            solution, beside = more, tried
    return solution.widths
