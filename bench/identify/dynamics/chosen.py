"""Solve: with the delay and the widths of the prior that held-out errors choose."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.identify.dynamics.band import Band
from bench.identify.dynamics.equations import OPTIONAL
from bench.identify.dynamics.folds import Folds
from bench.identify.dynamics.held_out import Missed, missed
from bench.identify.dynamics.normal import evidence_gain, posterior
from bench.identify.dynamics.prior import NARROWEST, Prior, Widths
from bench.identify.dynamics.rows import DriveRows
from bench.identify.dynamics.solve import Solution, solve

# declared: log evidence from where on a drive has it; 100 to 1, as a diagnosis asks of a finding
SURELY = float(np.log(100.0))
WANTED = {"viscous_difference": 0.0, "rolling": SURELY, "load": SURELY, "spring": SURELY}
# effort: of choosing widths anew with the noise that is left; a term that was found sharpens what tells the next
CHOICES = 5
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
    widths = None
    for _ in range(CHOICES):
        solution, beside = _with_its_noise(rows, prior, band, folds, find_delay, widths)
        chosen = _held_out_widths(solution, beside, prior, folds)
        if chosen == solution.widths:
            break
        widths = chosen
    return solution, beside


def _with_its_noise(
    rows: Sequence[DriveRows], prior: Prior, band: Band, folds: Folds, find_delay: bool, begin: Widths | None
) -> tuple[Solution, Missed]:
    """Return the posterior whose noise is what is missed beside its data, and that."""
    inflation = np.ones(len(rows))
    for _ in range(ROUNDS):
        beside = missed(solve(rows, prior, band.cutoff_hz, inflation, find_delay, begin), prior, folds)
        inflation = inflation * beside.excess
    solution = solve(rows, prior, band.cutoff_hz, inflation, find_delay, begin)
    return solution, missed(solution, prior, folds)


def _held_out_widths(solution: Solution, beside: Missed, prior: Prior, folds: Folds) -> Widths:
    """Return the widths with those that held-out errors choose: what is not needed to predict is left out.

    Scales of torques stay as read where all drives together are predicted no worse so, each by the logarithm of its
    error, and where what is held out repeats the rest, which is no test of them. An offset is held where its drive's
    torque is predicted no worse without it. What is optional (friction that differs between the directions, rolls, or
    grows with the load, and dress packs) is there where the evidence wants it and the drive is predicted better: it
    bends in what a model misses. All but the first is much like what a drive has anyway (Coulomb and viscous friction
    together; gravity and inertia), so chance has it in their place unless the evidence wants it for sure.
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
    for drive, noise in enumerate(solution.noise):
        if noise is not None:
            solution, beside = _with_optional(solution, beside, drive, prior, folds)
    return solution.widths


def _with_optional(
    solution: Solution, beside: Missed, drive: int, prior: Prior, folds: Folds
) -> tuple[Solution, Missed]:
    """Return a solution with what one drive has of `OPTIONAL`, the most wanted first, and what it misses."""
    n, one = len(solution.noise), solution.drives[drive]
    left = set(range(drive, len(solution.widths.optional), n))
    while left:
        parameters, _ = posterior(solution.normal, prior, solution.widths)
        readings = one.weight * float(np.sum((one.rows.response(solution.delay) - one.rows.model(parameters)) ** 2))
        gains, best = {}, {}
        for place in left:
            line = [solution.widths.with_optional(place, width) for width in range(NARROWEST, 1)]
            given = solution.normal, prior, solution.widths
            evidence = [evidence_gain(*given, widths, readings) for widths in line]
            gains[place] = max(evidence) - WANTED[OPTIONAL[place // n]]
            best[place] = line[int(np.argmax(evidence))]
        place = max(left, key=gains.__getitem__)
        if gains[place] <= 0:
            break
        left.remove(place)
        more = replace(solution, widths=best[place])
        tried = missed(more, prior, folds)
        if tried.squares[:, drive].sum() < beside.squares[:, drive].sum():
            solution, beside = more, tried
    return solution, beside
