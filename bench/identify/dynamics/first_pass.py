"""The first pass over a campaign's moving data: its parameters, and how well they predict what was held out."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.dynamics.band import Band, band_of
from bench.identify.dynamics.base_parameters import base_parameters
from bench.identify.dynamics.chosen import RARE
from bench.identify.dynamics.equations import BALANCER, Equations, equations_of
from bench.identify.dynamics.folds import blocks_of, folds_of
from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.held_out import SAME, Problems, hold_out, missed
from bench.identify.dynamics.normal import Weighed, normal_of, width_errors
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.prior import Prior, prior_of, weighed
from bench.identify.dynamics.rival import Rival, rival_of
from bench.identify.dynamics.rows import DriveRows, rows_of
from bench.identify.dynamics.samples import motion_samples
from bench.identify.dynamics.solve import Solution, odds_against_none, solve
from bench.identify.dynamics.stages import Fit, Setting
from bench.identify.dynamics.widths import NONE
from bench.record.campaign import Array, Campaign
from bench.robot.nominal_dynamics import NominalDynamics


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
    setting = Setting(layout, band, arm, nominal, prior, folds_of(stretches), find_delay)
    fit, solution = _fitted(setting, stretches)
    while unsure := _unsure_balancers(solution, layout):
        prior = prior.without("balancer", unsure)
        setting = replace(setting, prior=prior)
        fit, solution = _fitted(setting, stretches)
    rows = tuple(one.rows for one in solution.drives)
    rival = rival_of(layout, base)
    plain = _plain_weights(rows, rival, solution, prior)
    bodies = setting.bodies(solution)
    problems = Problems(solution, plain, prior, bodies, rival, layout.payloads if layout.carried else ())
    return FirstPass(
        nominal=nominal,
        arm=arm,
        layout=layout,
        base=base,
        band=band,
        rubbing=fit.rubbing,
        falls=fit.falls,
        travel=fit.travel,
        bending=fit.bending,
        leans=fit.leans,
        stretches=fit.stretches,
        problems=problems,
        parameters=setting.existing(solution),
        rival_parameters=rival.fit(normal_of(plain, solution.delay, layout.size)),
        folds=setting.folds,
        held_out=hold_out(problems, setting.folds),
        top_speed=top,
    )


def _fitted(setting: Setting, stretches: tuple[Equations, ...]) -> tuple[Fit, Solution]:
    """Return a fit, and its posterior with what its widths leave open."""
    fit = setting.leaning(setting.winding(setting.turning_late(setting.begun(stretches))))
    unsure = width_errors(fit.solution.normal, setting.prior, fit.solution.widths)
    return fit, replace(fit.solution, covariance=fit.solution.covariance + unsure)


def _unsure_balancers(solution: Solution, layout: Layout) -> tuple[int, ...]:
    """Return the drives whose balancer may as well be none, by all that the posterior leaves open.

    It was chosen at the noise and the widths of one fit: what gears and friction leave of an elbow that hardly moves
    alone, at odds of a thousand, is none by its own intervals.
    """
    found = []
    for drive, width in enumerate(solution.widths.optional_of("balancer")):
        which = np.array([np.arange(layout.size)[layout.of_drives(name)][drive] for name in BALANCER])
        if width != NONE and odds_against_none(solution, which) <= RARE:
            found.append(drive)
    return tuple(found)


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
