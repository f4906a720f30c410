"""Solve: with the delay and the widths of the prior that held-out errors choose."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.identify.dynamics.band import Band
from bench.identify.dynamics.equations import OPTIONAL
from bench.identify.dynamics.folds import Folds
from bench.identify.dynamics.held_out import Missed, missed
from bench.identify.dynamics.normal import evidence_gain, explained_by, posterior
from bench.identify.dynamics.prior import Prior
from bench.identify.dynamics.rows import DriveRows
from bench.identify.dynamics.solve import Solution, solve
from bench.identify.dynamics.widths import NARROWEST, NONE, Widths
from bench.record.campaign import Array

# declared: log evidence from where on a drive has it; 100 to 1, as a diagnosis asks of a finding
SURELY = float(np.log(100.0))
RARE = SURELY + float(np.log(10.0))  # declared: who has a machine with a balancer knows of it, who has cables may not
WANTED = dict.fromkeys(OPTIONAL, SURELY) | {"viscous_difference": 0.0, "balancer": RARE}
ADDING = ("rolling", "load", "presliding")  # exact: friction of these kinds takes energy, so their sizes are positive
# effort: of choosing widths anew with the noise that is left; a term that was found sharpens what tells the next
CHOICES = 5
ROUNDS = 2  # effort: of asking by how much the model errs beside its data; a third changes a tenth of that


def with_its_delay(
    rows: Sequence[DriveRows],
    prior: Prior,
    band: Band,
    folds: Folds,
    *,
    find_delay: bool,
    turns_late: bool = False,
    begin: Widths | None = None,
) -> tuple[Solution, Missed]:
    """Return the posterior, with a delay where that surely predicts what was held out better, and what it misses.

    Where it does not, the solution says which one a fit with one has.

    Args:
        rows: Of each drive.
        prior: Of the parameters.
        band: The filter that they passed.
        folds: What is held out at a time.
        find_delay: Whether torques may be later than angles.
        turns_late: Whether friction may turn late.
        begin: Widths to begin with, by default the usual.
    """
    solution, at_once = _solved(rows, prior, band, folds, find_delay=False, turns_late=turns_late, begin=begin)
    if find_delay:
        late, later = _solved(rows, prior, band, folds, find_delay=True, turns_late=turns_late, begin=begin)
        if later.surely_less_than(at_once):
            return late, later
        solution = replace(solution, not_taken=(late.delay, late.delay_sigma))
    return solution, at_once


def _solved(
    rows: Sequence[DriveRows],
    prior: Prior,
    band: Band,
    folds: Folds,
    find_delay: bool,
    turns_late: bool,
    begin: Widths | None,
) -> tuple[Solution, Missed]:
    """Return the posterior whose noise is what is missed beside its data, and that."""
    widths = begin
    for _ in range(CHOICES):
        solution, beside = _with_its_noise(rows, prior, band, folds, find_delay, widths)
        chosen = _held_out_widths(solution, beside, prior, folds)
        if turns_late:
            chosen = turning_late(replace(solution, widths=chosen), prior)
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
    grows with the load, dress packs and balancers) is there where the evidence wants it and the drive is predicted
    better: it bends in what a model misses. All but the first is much like what a drive has anyway (Coulomb and viscous
    friction together; gravity and inertia), so chance has it in their place unless the evidence wants it for sure.
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


def turning_late(solution: Solution, prior: Prior) -> Widths:
    """Return widths with friction that turns late in each drive whose torque is likelier so, or in none if not surely.

    A joint turns seldom, so hardly any drive has the readings to tell by itself. All of them together have to want it
    by 100 to 1. It is as optional friction otherwise, but it is for held-out errors of all drives to choose.
    """
    n = len(solution.noise)
    places = n * OPTIONAL.index("presliding") + np.arange(n)
    without = solution
    for place in places:
        without = replace(without, widths=without.widths.with_optional(int(place), NONE))
    widths, wanted = without.widths, 0.0
    for drive, place in enumerate(places):
        if solution.noise[drive] is None:
            continue
        gain, best = _most_wanted(without, drive, int(place), prior)
        if gain > 0 and _can_be(without, int(place), best, prior):  # friction does not turn before its joint
            widths = widths.with_optional(int(place), best.optional[place])
            wanted += gain
    return widths if wanted > SURELY else without.widths


def _most_wanted(solution: Solution, drive: int, place: int, prior: Prior) -> tuple[float, Widths]:
    """Return by how much what is optional of a drive raises the log evidence at best, and the widths with it."""
    widths = solution.widths
    before = explained_by(solution.normal, prior, widths)
    readings = _readings(solution, drive, before.parameters(prior))
    gains = {}
    for width in range(NARROWEST, 1):
        tried = widths.with_optional(place, width)
        after = explained_by(solution.normal, prior, tried)
        gains[tried] = evidence_gain(before, after, readings, _readings(solution, drive, after.parameters(prior)))
    best = max(gains, key=gains.__getitem__)
    return gains[best], best


def _can_be(solution: Solution, place: int, widths: Widths, prior: Prior) -> bool:
    """Return whether a size that something optional comes out with is one that it can have."""
    if OPTIONAL[place // len(solution.noise)] not in ADDING:
        return True
    where = np.flatnonzero(np.diag(prior.optional[place]))
    return bool(np.all(posterior(solution.normal, prior, widths)[0][where] > 0))


def _readings(solution: Solution, drive: int, parameters: Array) -> float:
    """Return the weighted squares that parameters leave of a drive: of its own, as many as its independent readings.

    Linear about the solution, as the evidence is: with what other widths make of masses, products are beyond it.
    """
    one = solution.drives[drive]
    return one.weight * float(np.sum((one.response(solution.delay) - one.factors @ parameters[one.rows.index]) ** 2))


def _shows(solution: Solution, drive: int, place: int, prior: Prior) -> bool:
    """Whether any row of a drive would show something optional, if it may be there."""
    rows = solution.drives[drive].rows
    return bool(np.any(rows.constant[:, np.diag(prior.optional[place])[rows.index] > 0]))


def _with_optional(
    solution: Solution, beside: Missed, drive: int, prior: Prior, folds: Folds
) -> tuple[Solution, Missed]:
    """Return a solution with what one drive has of `OPTIONAL`, the most wanted first, and what it misses.

    What came out, beside all else, with a size that it cannot have goes.
    """
    n = len(solution.noise)
    for place in range(drive, len(solution.widths.optional), n):
        if solution.widths.optional[place] != NONE and not _can_be(solution, place, solution.widths, prior):
            solution = replace(solution, widths=solution.widths.with_optional(place, NONE))
            beside = missed(solution, prior, folds)
    left = {
        place for place in range(drive, n * OPTIONAL.index("presliding"), n) if _shows(solution, drive, place, prior)
    }
    wanted: dict[int, tuple[float, Widths]] = {}  # beside the solution as it is
    while left:
        wanted = wanted or {place: _most_wanted(solution, drive, place, prior) for place in left}
        gains = {place: gain - WANTED[OPTIONAL[place // n]] for place, (gain, _) in wanted.items() if place in left}
        place = max(left, key=gains.__getitem__)
        if gains[place] <= 0:
            break
        left.remove(place)
        if not _can_be(solution, place, wanted[place][1], prior):
            continue
        more = replace(solution, widths=wanted[place][1])
        tried = missed(more, prior, folds)
        if tried.squares[:, drive].sum() < beside.squares[:, drive].sum():
            solution, beside, wanted = more, tried, {}
    return solution, beside
