"""What explains a campaign, with a robot as it is stated; where that is not enough, with links that nobody knows."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.baseline.comparison import Baseline, baseline_of
from bench.diagnose.conclude import unfinished_of
from bench.diagnose.cross_validation.held_out import HeldOut, held_out
from bench.diagnose.cross_validation.leave_out import REACH
from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.refit import refit
from bench.diagnose.extension import extension_of
from bench.diagnose.linearise.candidates import LARGER, Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.linearise.signatures import Signatures
from bench.diagnose.name.beginning import told_by
from bench.diagnose.name.beside_unlisted import beside_unlisted
from bench.diagnose.name.discrepancy import Discrepancy, discrepancy_of
from bench.diagnose.name.larger import may_be_larger
from bench.diagnose.name.naming import Naming
from bench.diagnose.name.neighbourhood import Neighbourhood
from bench.diagnose.name.selection import name_cause
from bench.diagnose.replay.given import with_earlier
from bench.diagnose.replay.known import with_known_segments
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import Segment, segments_of
from bench.diagnose.verdict import Unfinished
from bench.effects.effect import Effect
from bench.effects.recorded import Recorded, recorded_in
from bench.errors import NOT_SIMULATED, InputError
from bench.executor.contract import Executor
from bench.executor.watched import Check, Stopped
from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.held_out import SAME
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot

UNEXPLAINED = 2.0  # effort: standard errors that are left on average, from where that is worth another diagnosis
UNKNOWN_MASS = 1.0  # derived: relative uncertainty of a mass that nobody knows: none is one standard deviation away


class Phases:
    """Tells what is done next, and remembers it; between two phases the work may be stopped."""

    def __init__(self, progress: Callable[[str], None], check: Check) -> None:
        self._progress, self._check = progress, check
        self.now = ""

    def __call__(self, words: str) -> None:
        """Begin what is done next."""
        self._check()
        self.now = words
        self._progress(words)


@dataclass(frozen=True, eq=False)
class Task:
    """What is asked, as of `diagnose`."""

    campaign: Campaign
    compiled: CompiledRobot
    catalogue: Mapping[str, Effect]
    rate: float
    progress: Phases
    most_bins: int
    executor: Executor
    first: FirstPass | None


@dataclass(frozen=True, eq=False)
class Explained:
    """What explains a campaign.

    Attributes:
        signatures: That were weighed.
        segments: Of the campaign.
        naming: What was found.
        about: The campaign linearised about it.
        discrepancy: What became of what is not listed.
        extension: The model with what was found, listed or learned; None where there is nothing to add.
        gain: Of the model on what was held out.
        baseline: The model beside least squares.
        unfinished: Why it ended before it was done.
    """

    signatures: Signatures
    segments: tuple[Segment, ...]
    naming: Naming
    about: LinearisedModel
    discrepancy: Discrepancy | None = None
    extension: Fit | None = None
    gain: HeldOut | None = None
    baseline: Baseline | None = None
    unfinished: Unfinished | None = None

    @property
    def fit(self) -> Fit:
        """The model with what was found, or the nominal one."""
        return self.extension or self.naming.null

    @property
    def stand_ins(self) -> tuple[Cause, ...]:
        """Listed causes of that model in the place of something unlisted, which it does not have."""
        if self.naming.unlisted is None or (self.discrepancy and self.discrepancy.is_gain):
            return ()
        return tuple(cause for cause in self.fit.causes if cause.key not in self.naming.models[0].keys)


def explained(
    task: Task, signatures: Signatures, reach: float = 1.0, earlier: Sequence[Fit] = (), *, learns: bool = True
) -> Explained:
    """Return what explains a campaign, as far as time allows.

    Args:
        task: What is asked.
        signatures: Of the robot that is believed; what is not known of them is simulated.
        reach: Times what is plausible, that their causes go up to.
        earlier: Fits of the campaign with other priors, to begin from.
        learns: False: nothing is learned, nor weighed on what was held out, where something is unlisted.

    Raises:
        InputError: The campaign has nothing that a replay predicts.
        ConvergenceError: The model finds no balance along the measured motion.
        Stopped: Before anything was weighed.
    """
    campaign, compiled, progress = task.campaign, signatures.compiled, task.progress
    quantities = signatures.quantities
    told = told_by(task.first)
    segments = segments_of(campaign, compiled, quantities, task.most_bins)
    segments = with_known_segments(segments, campaign, compiled, quantities)
    segments = with_earlier(segments, quantities, signatures.nuisances)
    if not segments or not quantities:
        raise InputError(
            "the campaign has no channel that a replay predicts: log motor currents or torques, a reflector, a link "
            "encoder, or the gas pressure, beside the motor angles."
        )
    progress(f"signatures of {len(signatures.causes)} causes")
    sensitivities = signatures.sensitivities(segments, task.executor)
    linear = linearised_model_of(Replay(compiled, segments, quantities), signatures.nuisances, sensitivities.nuisances)
    progress("naming")
    recorded = recorded_by(campaign, compiled)
    measured = measured_by(campaign)
    around = Neighbourhood(compiled, task.catalogue, measured, task.rate, task.executor, recorded, reach, told)
    linear, screening = around.weighed(linear, signatures.causes, sensitivities)
    naming = name_cause(linear, screening, around, progress, task.executor, earlier, told, learns=learns)
    found = Explained(signatures, segments, naming, naming.linear)
    try:
        if naming.stopped:
            raise Stopped(naming.stopped)
        if naming.unlisted and not learns:
            return found
        if naming.unlisted:
            progress("learning what is not listed")
            discrepancy = discrepancy_of(naming)
            naming = beside_unlisted(naming, discrepancy)
            about = discrepancy.linear if discrepancy and discrepancy.is_gain else naming.linear
            found = replace(found, naming=naming, discrepancy=discrepancy, about=about)
        found = replace(found, extension=extension_of(naming, found.discrepancy))
        if found.extension:
            progress("gain on what was held out")
            null = naming.null if found.about is naming.linear else refit(found.about, (), {}, settles=False)
            found = replace(found, gain=held_out(found.about, null, found.extension))
        if task.first:
            progress("least squares beside it")
            with suppress(np.linalg.LinAlgError):  # without a part of the data, its equations may be singular
                baseline = baseline_of(found.about, found.fit, task.first, task.rate)
                found = replace(found, baseline=baseline)
    except Stopped as stopped:
        found = replace(found, unfinished=unfinished_of(naming, str(stopped), progress.now))
    return found


def beside_unknown_links(
    task: Task, found: Explained, signatures_about: Callable[[CompiledRobot], Signatures]
) -> Explained:
    """Return what explains a campaign if nobody knew how the links weigh, where that predicts torques better.

    Least squares, which believes nothing of what is stated, predicted better: then masses, centres of mass and moments
    of inertia may be off everywhere by more than is stated, which is no list of single causes.

    Args:
        task: What is asked.
        found: What explains the campaign with links as they are stated, beside least squares.
        signatures_about: Returns those of another robot.
    """
    uncertainty = task.compiled.robot.figures.uncertainty
    if not 0 < uncertainty.links * uncertainty.mass < UNKNOWN_MASS:
        return found
    task.progress("once more, with links as good as unknown")
    figures = task.compiled.robot.figures.model_copy(
        update={"uncertainty": uncertainty.model_copy(update={"links": UNKNOWN_MASS / uncertainty.mass})}
    )
    compiled = replace(task.compiled, robot=replace(task.compiled.robot, figures=figures))
    other = _once_more(task, found, signatures_about(compiled))
    assert found.baseline
    is_better = other.baseline is not None and other.baseline.over(found.baseline) < 1 / SAME
    return other if other.unfinished or is_better else found


def is_open(found: Explained) -> bool:
    """Whether something is unlisted, or nothing was found but with figures that are farther off than figures are."""
    if found.unfinished:
        return False
    if found.naming.models:
        return found.naming.unlisted is not None
    left = found.about.whiten(found.fit.residual)
    is_missed = bool(found.baseline and found.baseline.lags) or float(np.mean(left**2)) > UNEXPLAINED**2
    return is_missed or float(np.max(np.abs(found.fit.nuisances), initial=0.0)) > REACH


def beyond_plausible(task: Task, found: Explained) -> Explained:
    """Return what explains a campaign if causes may be several times as large as is plausible, where nothing else does.

    Only priors differ. What causes change to first order is known from before, and fits begin at those that were found
    (but for plays, which are looked for from the largest size): the likelihood is the same, each fit ends where its
    posterior is largest, and what is weighed and held out is weighed and held out anew.

    Where listed causes as large as that explain little of what a free shape does, no fit makes that up, and they are
    not fitted.

    Friction may be three times what is stated, and most of the gas may be gone. That is told as what it looks like, to
    be checked first: another cause, a figure or a channel may be as wrong.

    Args:
        task: What is asked.
        found: What explains the campaign with plausible causes.
    """
    if not may_be_larger(found.naming):
        return found
    task.progress(f"once more, with causes up to {LARGER:g} times as large as is plausible")
    earlier = [m.fit for m in found.naming.models if not any(cause.effect.scatters for cause in m.causes)]
    other = _once_more(task, found, found.signatures.farther(LARGER), LARGER, earlier, learns=False)
    explains = bool(other.naming.models) and other.naming.unlisted is None
    is_as_good = explains and _misfit(other) < _misfit(found) + np.log(SAME)
    return other if other.unfinished or is_as_good else found


def _once_more(
    task: Task,
    found: Explained,
    signatures: Signatures,
    reach: float = 1.0,
    earlier: Sequence[Fit] = (),
    *,
    learns: bool = True,
) -> Explained:
    """Return what explains a campaign by other signatures; what was found, where that is stopped or not simulated."""
    try:
        other = explained(task, signatures, reach, earlier, learns=learns)
    except Stopped as stopped:
        return replace(found, unfinished=unfinished_of(found.naming, str(stopped), task.progress.now))
    except NOT_SIMULATED:
        return found
    return replace(found, unfinished=other.unfinished) if other.unfinished else other


def _misfit(found: Explained) -> float:
    """Return what the model leaves over what instruments scatter, the logarithm of its mean over all channels."""
    left, shown = found.fit.residual, np.isfinite(found.fit.residual)
    sigma = np.concatenate([segment.sigma for segment in found.segments])
    square = np.where(shown & (sigma > 0), left / np.where(sigma > 0, sigma, 1.0), np.nan) ** 2
    seen = [c for c in range(left.shape[1]) if np.any(np.isfinite(square[:, c]))]
    return float(np.mean([np.log(np.nanmean(square[:, c])) / 2 for c in seen])) if seen else 0.0


def measured_by(campaign: Campaign) -> frozenset[str]:
    """Return the quantities of a campaign, without numbers and units."""
    names = {name for run in campaign.runs for name in run.columns}
    words = (name.split("_")[:-1] for name in names)
    return frozenset("_".join(word for word in part if not word.isdigit()) for part in words)


def recorded_by(campaign: Campaign, compiled: CompiledRobot) -> Recorded:
    """Return the runs and columns of a campaign, where errors of its recording may sit."""
    return recorded_in(campaign.runs, compiled.model.opt.gravity)
