"""The first pass over a campaign's moving data: its parameters, and how well they predict what was held out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.dynamics.band import Band, band_of
from bench.identify.dynamics.base_parameters import BaseParameters, base_parameters
from bench.identify.dynamics.consistency import Bodies, bodies_of, nearest
from bench.identify.dynamics.equations import Equations, equations_of
from bench.identify.dynamics.folds import Folds, folds_of
from bench.identify.dynamics.held_out import HeldOut, Missed, Problems, hold_out, missed
from bench.identify.dynamics.normal import Weighed, log_evidence, normal_of, width_errors
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.prior import NARROWEST, NONE, Prior, Widths, prior_of, weighed
from bench.identify.dynamics.rival import Rival, rival_of
from bench.identify.dynamics.rows import DriveRows, drive_rows
from bench.identify.dynamics.samples import MotionSamples, motion_samples
from bench.identify.dynamics.solve import Solution, solve
from bench.record.campaign import Array, Campaign
from bench.robot.nominal_dynamics import NominalDynamics

ROUNDS = 2  # of asking by how much the model errs beside its data; a third changes a tenth of that


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
    def joints(self) -> tuple[str, ...]:
        """Names of the joints."""
        return self.nominal.bodies.names

    def quantile(self, level: float = 0.9) -> float:
        """Return half the width of an interval in standard errors; Student's t with the independent readings left."""
        return float(stats.t.ppf(0.5 + level / 2, self.solution.freedom))

    def rows(self, stretches: Sequence[Equations], band: Band | None = None) -> tuple[DriveRows, ...]:
        """Return the equations of each drive, from stretches that passed `band`, by default that of the fit."""
        given = self.layout, band or self.band, self.arm, self.nominal
        return tuple(drive_rows(stretches, j, *given) for j in range(self.layout.n))

    def predict(self, campaign: Campaign) -> Torques:
        """Return what nominal model, rival and first pass predict of another campaign; nothing is fitted.

        Raises:
            InputError: It has no motion with torques.
        """
        samples = motion_samples(campaign, self.nominal)
        return self.torques(_equations(samples, self.band, self.arm, self.nominal, self.top_speed))

    def torques(self, stretches: Sequence[Equations]) -> Torques:
        """Return measured and predicted torques of thinned equations."""
        rows, late = self.rows(stretches), self.solution.delay
        return Torques(
            joints=self.joints,
            measured=tuple(one.response(late) + one.known for one in rows),
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
    layout = Layout(nominal.n_joints, nominal.payload > 0, nominal.counterbalance is not None)
    base = base_parameters(arm, layout, nominal.load_point)
    samples = motion_samples(campaign, nominal)
    band = band_of(samples, cutoff_hz)
    top = np.max([np.abs(band.smooth(part)[1]).max(axis=0) for part in samples], axis=0)
    stretches = _equations(samples, band, arm, nominal, top)
    rows = tuple(drive_rows(stretches, j, layout, band, arm, nominal) for j in range(layout.n))
    if not any(len(one) for one in rows):
        raise InputError(
            f"method 'dynamics': after the low-pass of {band.cutoff_hz:.3g} Hz no sample is left in which a joint "
            "moves and its torque was read; state a higher cut-off, or record for longer."
        )
    prior = prior_of(layout, nominal, arm, *_sizes(rows, layout, nominal.speed_limit))
    folds = folds_of(stretches)
    solution, at_once = _solved(rows, prior, band, folds, find_delay=False)
    if find_delay:
        late, later = _solved(rows, prior, band, folds, find_delay=True)
        solution = late if later.surely_less_than(at_once) else solution
    unsure = width_errors(solution.normal, prior, solution.widths)
    solution = replace(solution, covariance=solution.covariance + unsure)
    bodies = bodies_of(layout, arm.joint_names, prior.mean, solution.prior_sigma, nominal.payload, nominal.payload_side)
    factor = prior.factor(solution.widths)
    rival = rival_of(layout, base)
    plain = _plain_weights(rows, rival, solution, prior)
    problems = Problems(solution, plain, prior, bodies, rival)
    return FirstPass(
        nominal=nominal,
        arm=arm,
        layout=layout,
        base=base,
        band=band,
        stretches=stretches,
        problems=problems,
        parameters=nearest(bodies, solution.parameters, prior.mean, factor, solution.normal.gram),
        rival_parameters=rival.fit(normal_of(plain, solution.delay, layout.size)),
        folds=folds,
        held_out=hold_out(problems, folds),
        top_speed=top,
    )


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
    error. An offset is held where its drive's torque is predicted no worse without it. Viscous friction differs between
    the directions where the evidence wants that and the drive is predicted better: it bends in what a model misses.
    """
    as_read = replace(solution, widths=replace(solution.widths, scale=NARROWEST))
    tried = missed(as_read, prior, folds)
    if tried.misfit <= beside.misfit:
        solution, beside = as_read, tried
    for drive, width in enumerate(solution.widths.offset):
        if width == NARROWEST or solution.noise[drive] is None:
            continue
        without = replace(solution, widths=solution.widths.holding(drive))
        tried = missed(without, prior, folds)
        if tried.squares[:, drive].sum() <= beside.squares[:, drive].sum():
            solution, beside = without, tried
    for drive, noise in enumerate(solution.noise):
        if noise is None:
            continue
        line = [solution.widths.differing(drive, width) for width in range(NONE, 1)]
        best = max(line, key=lambda widths: log_evidence(solution.normal, prior, widths))
        if best == solution.widths:
            continue
        uneven = replace(solution, widths=best)
        tried = missed(uneven, prior, folds)
        if tried.squares[:, drive].sum() < beside.squares[:, drive].sum():
            solution, beside = uneven, tried
    return solution.widths


def _equations(
    samples: Sequence[MotionSamples], band: Band, arm: Arm, nominal: NominalDynamics, top: Array
) -> tuple[Equations, ...]:
    found = (equations_of(part, band, arm, nominal, top) for part in samples)
    return tuple(part for part in found if len(part))


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
