"""The first pass over a campaign's moving data: its parameters, and how well they predict what was held out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.dynamics.band import Band, band_of
from bench.identify.dynamics.base_parameters import BaseParameters, base_parameters
from bench.identify.dynamics.bending import Bending, bending_of, bent
from bench.identify.dynamics.chosen import turning_late, with_its_delay
from bench.identify.dynamics.consistency import Bodies, bodies_of, nearest
from bench.identify.dynamics.equations import OPTIONAL, Equations, equations_of
from bench.identify.dynamics.folds import Folds, blocks_of, folds_of
from bench.identify.dynamics.found_arm import FoundArm, found_arm
from bench.identify.dynamics.gear_load import loaded
from bench.identify.dynamics.held_out import SAME, HeldOut, Problems, hold_out, missed
from bench.identify.dynamics.normal import Weighed, normal_of, width_errors
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.presliding import late, likeliest_travel
from bench.identify.dynamics.prior import NONE, Prior, prior_of, weighed
from bench.identify.dynamics.rival import Rival, rival_of
from bench.identify.dynamics.rows import DriveRows, drive_rows
from bench.identify.dynamics.samples import MotionSamples, motion_samples
from bench.identify.dynamics.solve import Solution, solve
from bench.record.campaign import Array, Campaign
from bench.robot.nominal_dynamics import NominalDynamics


@dataclass(frozen=True)
class Torques:
    """What three models predict of the torque of each drive where it moves, after the stated filter.

    Attributes:
        joints: Names.
        measured, nominal, rival, first_pass: For each drive shape (R,) [Nm] or [N].
    """

    joints: tuple[str, ...]
    measured: tuple[Array, ...]
    nominal: tuple[Array, ...]
    rival: tuple[Array, ...]
    first_pass: tuple[Array, ...]

    def rms(self, model: str) -> Array:
        """Return the root mean square error of a model, shape (n,) [Nm]; nan for a drive that does not move.

        Args:
            model: "nominal", "rival" or "first_pass"; "measured" gives the torque's own.
        """
        found = []
        for measured, predicted in zip(self.measured, getattr(self, model), strict=True):
            error = measured if model == "measured" else measured - predicted
            found.append(float(np.sqrt(np.mean(error**2))) if len(error) else np.nan)
        return np.array(found)


@dataclass(frozen=True)
class FirstPass:
    """What moving data say of the dynamics by linear regression.

    Attributes:
        nominal: The robot as stated.
        arm: Its links.
        layout: Of the parameters.
        base: Its base parameters.
        band: The filter that model and data passed.
        rubbing: The arm whose torque friction grows with.
        travel: Shape (n,) [rad] or [m], over which friction turns where it turns late; elsewhere it means nothing.
        bending: How its gears wind up; None where what was held out is not surely predicted better for it.
        stretches: The thinned equations.
        problems: What was solved: prior, posterior, constraints, and plain least squares.
        parameters: Shape (p,), the posterior's most probable point among bodies that can exist: the result.
        rival_parameters: Shape (p,), its solution.
        folds: What was held out at a time.
        held_out: Errors on what was held out.
        top_speed: Shape (n,), of each joint in the campaign; slower than 8 % of it a joint does not count as moving.
    """

    nominal: NominalDynamics
    arm: Arm
    layout: Layout
    base: BaseParameters
    band: Band
    rubbing: FoundArm
    travel: Array
    bending: Bending | None
    stretches: tuple[Equations, ...]
    problems: Problems
    parameters: Array
    rival_parameters: Array
    folds: Folds
    held_out: HeldOut
    top_speed: Array

    @property
    def prior(self) -> Prior:
        """Of the parameters."""
        return self.problems.prior

    @property
    def solution(self) -> Solution:
        """The posterior, as if any number would do."""
        return self.problems.solution

    @property
    def bodies(self) -> Bodies:
        """What makes bodies that can exist of the parameters."""
        return self.problems.bodies

    @property
    def compliance(self) -> Array | None:
        """Shape (n,) [rad/Nm] or [m/N], of the gears, to first order; None where they are taken to be rigid."""
        if self.bending is None:
            return None
        return np.where(self.bending.winds, self.parameters[self.layout.softness], 0.0) / self.nominal.stiffness

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints."""
        return self.nominal.bodies.names

    @property
    def has(self) -> dict[str, tuple[int, ...]]:
        """Which drives have what of `OPTIONAL`, by name: what evidence and held-out errors want."""
        there = np.reshape([width != NONE for width in self.solution.widths.optional], (len(OPTIONAL), self.layout.n))
        return {name: tuple(np.flatnonzero(row).tolist()) for name, row in zip(OPTIONAL, there, strict=True)}

    def quantile(self, level: float = 0.9) -> float:
        """Return half the width of an interval in standard errors; Student's t with the independent readings left."""
        return float(stats.t.ppf(0.5 + level / 2, self.solution.freedom))

    def rows(self, stretches: Sequence[Equations], band: Band | None = None) -> tuple[DriveRows, ...]:
        """Return the equations of each drive, from stretches that passed `band`, by default that of the fit."""
        given = self.layout, band or self.band, self.arm, self.nominal
        return _rows(stretches, *given)

    def equations(self, samples: MotionSamples, band: Band | None = None) -> Equations:
        """Return the equations of a stretch that passes `band`, by default that of the fit."""
        band = band or self.band
        every = loaded([equations_of(samples, band, self.arm, self.nominal, self.top_speed)], self.rubbing, band)
        (found,) = late(every, self.travel, band)
        return bent(found, self.bending, band) if self.bending else found

    def predict(self, campaign: Campaign) -> Torques:
        """Return what nominal model, rival and first pass predict of another campaign; nothing is fitted.

        Raises:
            InputError: It has no motion with torques.
        """
        samples = motion_samples(campaign, self.nominal)
        found = [self.equations(part) for part in samples]
        return self.torques([part for part in found if len(part)])

    def torques(self, stretches: Sequence[Equations]) -> Torques:
        """Return measured and predicted torques of thinned equations."""
        rows, delay = self.rows(stretches), self.solution.delay
        return Torques(
            joints=self.joints,
            measured=tuple(one.response(delay) + one.known for one in rows),
            nominal=tuple(one.model(self.prior.mean) + one.known for one in rows),
            rival=tuple(one.model(self.rival_parameters) + one.known for one in rows),
            first_pass=tuple(one.model(self.parameters) + one.known for one in rows),
        )

    def held_out_rms(self, fold: int | None = None) -> Array:
        """Return the root mean square error on what was held out, shape (n,) [Nm]; of all folds, or of one."""
        return self.held_out.rms("first_pass", fold)


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
    rows = _rows(stretches, layout, band, arm, nominal)
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

    rubbing = existing(solve(rows, prior, band.cutoff_hz, np.ones(layout.n), find_delay))
    stretches = loaded(stretches, rubbing, band)
    rows = _rows(stretches, layout, band, arm, nominal)
    solution, beside = with_its_delay(rows, prior, band, folds, find_delay=find_delay)

    def solved(parts: Sequence[Equations]) -> Solution:
        given = _rows(parts, layout, band, arm, nominal), prior, band.cutoff_hz, np.ones(layout.n)
        return solve(*given, find_delay=solution.delay != 0, begin=solution.widths)

    travel = likeliest_travel(stretches, layout, prior, band, solution, solved)
    late_stretches = late(stretches, travel, band)
    late_rows = _rows(late_stretches, layout, band, arm, nominal)
    asked = turning_late(_with_rows(solution, late_rows, layout.size), prior)
    if turns_late := asked != solution.widths:
        turning, beside_turning = with_its_delay(late_rows, prior, band, folds, find_delay=find_delay, turns_late=True)
        if turns_late := beside_turning.surely_less_than(beside):
            solution, beside = turning, beside_turning
    stretches, rows = late_stretches, late_rows
    bending = bending_of(existing(solution))
    bent_stretches = tuple(bent(part, bending, band) for part in stretches)
    while True:
        bent_rows = _rows(bent_stretches, layout, band, arm, nominal)
        once = solve(bent_rows, prior, band.cutoff_hz, np.ones(layout.n), find_delay)
        backwards = bending.winds & (once.parameters[layout.softness] < 0)  # no gear winds up so
        if not backwards.any():
            break
        bending = replace(bending, winds=bending.winds & ~backwards)
        bent_stretches = tuple(replace(part, winding=part.winding * bending.winds) for part in bent_stretches)
    is_bent = False
    if bending.winds.any():
        wound, beside_wound = with_its_delay(
            bent_rows, prior, band, folds, find_delay=find_delay, turns_late=turns_late
        )
        if is_bent := beside_wound.surely_less_than(beside):
            solution, stretches, rows = wound, bent_stretches, bent_rows
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
        bending=bending if is_bent else None,
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
        rows = _rows(stretches, layout, band, arm, nominal)
        if not any(map(len, rows)):
            return shared
        prior = prior_of(layout, nominal, arm, *_sizes(rows, layout, nominal.speed_limit))
        beside.append(missed(solve(rows, prior, band.cutoff_hz, np.ones(layout.n), find_delay=False), prior, folds))
    # what a recording says of its own payload, no other recording can check: no drive may suffer
    return each if beside[1].surely_less_than(beside[0], worse=SAME) else shared


def _rows(
    stretches: Sequence[Equations], layout: Layout, band: Band, arm: Arm, nominal: NominalDynamics
) -> tuple[DriveRows, ...]:
    return tuple(drive_rows(stretches, j, layout, band, arm, nominal) for j in range(layout.n))


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
    drives = tuple(Weighed(new, new.factors(about), old.weight) for new, old in zip(rows, solution.drives, strict=True))
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
        drives = tuple(Weighed(one, one.factors(about), w) for one, w in zip(rows, weights, strict=True))
        found = rival.fit(normal_of(drives, solution.delay, size))
        left = [one.response(solution.delay) - one.model(found) for one in rows]
        weights = [1 / max(float(np.mean(e**2)), np.finfo(float).tiny) if len(e) else 0.0 for e in left]
    return tuple(Weighed(one, one.factors(about), w) for one, w in zip(rows, weights, strict=True))
