"""The first pass over a campaign's moving data: its parameters, and how well they predict what was held out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.dynamics.band import Band, band_of
from bench.identify.dynamics.base_parameters import base_parameters
from bench.identify.dynamics.bending import Bending, bending_of, bent
from bench.identify.dynamics.chosen import turning_late, with_its_delay
from bench.identify.dynamics.consistency import Bodies, bodies_of, nearest
from bench.identify.dynamics.equations import Equations, equations_of
from bench.identify.dynamics.folds import blocks_of, folds_of
from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.found_arm import FoundArm, found_arm
from bench.identify.dynamics.gear_load import loaded
from bench.identify.dynamics.held_out import SAME, Missed, Problems, hold_out, missed
from bench.identify.dynamics.leaning import leaning, seems_to_lean
from bench.identify.dynamics.normal import Weighed, normal_of, width_errors
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.presliding import late, likeliest_travel
from bench.identify.dynamics.prior import Prior, Widths, prior_of, weighed
from bench.identify.dynamics.rival import Rival, rival_of
from bench.identify.dynamics.rows import DriveRows, rows_of
from bench.identify.dynamics.samples import motion_samples
from bench.identify.dynamics.solve import Solution, solve
from bench.record.campaign import Array, Campaign
from bench.robot.nominal_dynamics import NominalDynamics


@dataclass(frozen=True)
class _Fit:
    """A posterior, what it misses of what was held out, and the equations that it is of."""

    solution: Solution
    beside: Missed
    stretches: tuple[Equations, ...]


def first_pass(
    campaign: Campaign, nominal: NominalDynamics, cutoff_hz: float | None = None, find_delay: bool = True
) -> FirstPass:
    """Identify the dynamics from the motion runs of a campaign.

    Args:
        campaign: With motor torques or currents in motion runs.
        nominal: The robot, from `bench.robot.nominal_dynamics`.
        cutoff_hz: Of the filter on model and data [Hz]; None: from the bandwidth of the motion.
        find_delay: Whether torques may have been read later than angles. A delay is taken where what was held out is
            predicted better with it for sure, and for no drive worse: what is late in a channel is late in all, and
            friction that builds up over a short way after a turn looks like a delay, too.

    Raises:
        InputError: No motion run has torques or currents, nothing moves, or the cut-off is no frequency to filter at.
    """
    nominal = weighed(nominal, campaign)
    arm = Arm(nominal.bodies)
    samples = motion_samples(campaign, nominal)
    band = band_of(samples, cutoff_hz)
    top = np.max([np.abs(band.smooth(part)[1]).max(axis=0) for part in samples], axis=0)
    every = (equations_of(part, band, arm, nominal, top) for part in samples)
    stretches = tuple(part for part in every if len(part))
    layout = _layout_of(stretches, band, arm, nominal)
    base = base_parameters(arm, layout, nominal.load_point)
    rows = rows_of(stretches, layout, band, arm, nominal)
    if not any(len(one) for one in rows):
        raise InputError(
            f"method 'dynamics': after the low-pass of {band.cutoff_hz:.3g} Hz no sample is left in which a joint "
            "moves and its torque was read; state a higher cut-off, or record for longer."
        )
    prior = prior_of(layout, nominal, arm, *_sizes(rows, layout, nominal.speed_limit))
    folds = folds_of(stretches)

    def existing(found: Solution) -> FoundArm:
        bodies = _bodies(layout, arm, prior, found, nominal)
        return found_arm(nominal, arm, layout, _existing(bodies, found, prior))

    def solved(parts: Sequence[Equations], *, find_delay: bool = find_delay, begin: Widths | None = None) -> Solution:
        given = rows_of(parts, layout, band, arm, nominal), prior, band.cutoff_hz, np.ones(layout.n)
        return solve(*given, find_delay, begin=begin)

    rubbing = existing(solved(stretches))
    stretches = loaded(stretches, rubbing, band)
    rows = rows_of(stretches, layout, band, arm, nominal)
    solution, beside = with_its_delay(rows, prior, band, folds, find_delay=find_delay)

    def turning_about(find_delay: bool) -> tuple[Array, tuple[Equations, ...], tuple[DriveRows, ...]]:
        about_it = partial(solved, find_delay=find_delay, begin=solution.widths)
        travel = likeliest_travel(stretches, layout, prior, band, solution, about_it)
        late_stretches = late(stretches, travel, band)
        return travel, late_stretches, rows_of(late_stretches, layout, band, arm, nominal)

    travel, late_stretches, late_rows = turning_about(solution.delay != 0)
    asked = turning_late(_with_rows(solution, late_rows, layout.size), prior)
    if turns_late := asked != solution.widths:
        turning, beside_turning = with_its_delay(late_rows, prior, band, folds, find_delay=find_delay, turns_late=True)
        if turns_late := beside_turning.surely_less_than(beside):
            # late friction may have been a delay, about which its travels were found
            if (turning.delay != 0) != (solution.delay != 0):
                travel, late_stretches, late_rows = turning_about(turning.delay != 0)
                turning, beside_turning = with_its_delay(
                    late_rows, prior, band, folds, find_delay=turning.delay != 0, turns_late=True
                )
            solution, beside = turning, beside_turning

    def fitted(parts: tuple[Equations, ...], begin: Widths | None = None) -> _Fit:
        own = rows_of(parts, layout, band, arm, nominal)
        given = own, prior, band, folds
        return _Fit(*with_its_delay(*given, find_delay=find_delay, turns_late=turns_late, begin=begin), parts)

    def softness(parts: Sequence[Equations]) -> Array:
        return solved(parts).parameters[layout.softness]

    def winding_too(now: _Fit, begin: Widths | None = None) -> tuple[Bending | None, _Fit]:
        bending, parts = _winding_forwards(bending_of(existing(now.solution)), now.stretches, band, softness)
        wound = fitted(parts, begin) if bending.winds.any() else now
        return (bending, wound) if wound.beside.surely_less_than(now.beside) else (None, now)

    bending, fit = winding_too(_Fit(solution, beside, late_stretches))
    tilted = leaning(fit.stretches, arm, nominal)
    likely = solved(tilted, find_delay=fit.solution.delay != 0, begin=fit.solution.widths)
    if leans := seems_to_lean(likely, layout):
        leant = fitted(tilted, fit.solution.widths)
        if leans := leant.beside.surely_less_than(fit.beside):
            # that was noise so far, about which all else was found: what slewing gears pass on, travels, winding
            begin, rubbing = leant.solution.widths, existing(leant.solution)
            stretches = leaning(loaded(stretches, rubbing, band), arm, nominal)
            if turns_late:
                about_it = partial(solved, find_delay=leant.solution.delay != 0, begin=begin)
                travel = likeliest_travel(stretches, layout, prior, band, leant.solution, about_it)
            bending, fit = winding_too(fitted(late(stretches, travel, band), begin), begin)
    solution, stretches, rows = fit.solution, fit.stretches, tuple(one.rows for one in fit.solution.drives)
    unsure = width_errors(solution.normal, prior, solution.widths)
    solution = replace(solution, covariance=solution.covariance + unsure)
    bodies = _bodies(layout, arm, prior, solution, nominal)
    rival = rival_of(layout, base)
    plain = _plain_weights(rows, rival, solution, prior)
    problems = Problems(solution, plain, prior, bodies, rival, layout.payloads if layout.carried else ())
    return FirstPass(
        nominal=nominal,
        arm=arm,
        layout=layout,
        base=base,
        band=band,
        rubbing=rubbing,
        travel=travel,
        bending=bending,
        leans=leans,
        stretches=stretches,
        problems=problems,
        parameters=_existing(bodies, solution, prior),
        rival_parameters=rival.fit(normal_of(plain, solution.delay, layout.size)),
        folds=folds,
        held_out=hold_out(problems, folds),
        top_speed=top,
    )


def _layout_of(stretches: Sequence[Equations], band: Band, arm: Arm, nominal: NominalDynamics) -> Layout:
    """Return the parameters: a payload for each recording where that surely predicts better, else one in all."""
    shared = Layout(nominal.n_joints, nominal.payload > 0, nominal.counterbalance is not None)
    recordings = tuple(dict.fromkeys(part.samples.recording for part in stretches))
    if not shared.has_payload or len(recordings) < 2:
        return shared
    each, folds = replace(shared, carried=recordings), blocks_of(stretches)
    beside = []
    for layout in (shared, each):
        rows = rows_of(stretches, layout, band, arm, nominal)
        if not any(map(len, rows)):
            return shared
        prior = prior_of(layout, nominal, arm, *_sizes(rows, layout, nominal.speed_limit))
        beside.append(missed(solve(rows, prior, band.cutoff_hz, np.ones(layout.n), find_delay=False), prior, folds))
    # what a recording says of its own payload, no other recording can check: no drive may suffer
    return each if beside[1].surely_less_than(beside[0], worse=SAME) else shared


def _winding_forwards(
    bending: Bending, stretches: Sequence[Equations], band: Band, softness: Callable[[Sequence[Equations]], Array]
) -> tuple[Bending, tuple[Equations, ...]]:
    """Return the gears that wind up with their torque, for none does against it, and the equations with that.

    Args:
        bending: How all gears would wind up.
        stretches: Equations of an arm with rigid gears.
        band: The filter that they passed.
        softness: Returns how much softer than stated each gear comes out, shape (n,).
    """
    found = tuple(bent(part, bending, band) for part in stretches)
    while np.any(backwards := bending.winds & (softness(found) < 0)):
        bending = replace(bending, winds=bending.winds & ~backwards)
        found = tuple(replace(part, winding=part.winding * bending.winds) for part in found)
    return bending, found


def _bodies(layout: Layout, arm: Arm, prior: Prior, solution: Solution, nominal: NominalDynamics) -> Bodies:
    payload = nominal.payload, nominal.payload_side
    return bodies_of(layout, arm.joint_names, prior.mean, solution.prior_sigma, *payload)


def _existing(bodies: Bodies, solution: Solution, prior: Prior) -> Array:
    """Return the most probable parameters of bodies that can exist, shape (p,)."""
    factor = prior.factor(solution.widths)
    return nearest(bodies, solution.parameters, prior.mean, factor, solution.normal.gram)


def _with_rows(solution: Solution, rows: Sequence[DriveRows], size: int) -> Solution:
    """Return a solution with the normal equations of other rows, about the same parameters and weighted alike."""
    about = solution.parameters
    drives = tuple(Weighed.about(new, about, old.weight) for new, old in zip(rows, solution.drives, strict=True))
    return replace(solution, drives=drives, normal=normal_of(drives, solution.delay, size))


def _sizes(rows: Sequence[DriveRows], layout: Layout, speed_limit: Array) -> tuple[Array, Array]:
    """Return the root mean squares of torque and speed of each drive where it moves, shape (n,).

    For a drive that never does, the largest torque of the others and its speed limit stand in.
    """
    torque, speed = np.full(layout.n, np.nan), speed_limit.copy()
    viscous = np.arange(layout.size)[layout.of_drives("viscous")]
    for j, one in enumerate(rows):
        if len(one):
            torque[j] = np.sqrt(np.mean(one.response(0.0) ** 2))
            speed[j] = np.sqrt(np.mean(one.constant[:, one.index == viscous[j]] ** 2))
    return np.where(np.isnan(torque), np.nanmax(torque), torque), speed


def _plain_weights(rows: Sequence[DriveRows], rival: Rival, solution: Solution, prior: Prior) -> tuple[Weighed, ...]:
    """Return the rows as plain least squares takes them: each drive by the variance of its own residuals."""
    size = len(prior.mean)
    about = prior.mean.copy()
    weights = [
        1.0 / max(float(np.mean(one.response(solution.delay) ** 2)), np.finfo(float).tiny) if len(one) else 0.0
        for one in rows
    ]
    for _ in range(2):  # once with equal relative weights, then by the residuals of that (weighted IDIM-LS)
        drives = tuple(Weighed.about(one, about, w) for one, w in zip(rows, weights, strict=True))
        found = rival.fit(normal_of(drives, solution.delay, size))
        left = [one.response(solution.delay) - one.model(found) for one in rows]
        weights = [1 / max(float(np.mean(e**2)), np.finfo(float).tiny) if len(e) else 0.0 for e in left]
    return tuple(Weighed.about(one, about, w) for one, w in zip(rows, weights, strict=True))
