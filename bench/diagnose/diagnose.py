"""From a campaign to a naming: replay, screen, refit. Extension files are written by `bench.report.diagnosis`."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from threadpoolctl import threadpool_limits

from bench.diagnose.baseline.comparison import Baseline, baseline_of
from bench.diagnose.conclude import unfinished_of, verdict_of
from bench.diagnose.cross_validation.held_out import HeldOut, PredictedError, held_out
from bench.diagnose.cross_validation.jackknife import with_jackknife
from bench.diagnose.cross_validation.next_recording import predicted_error
from bench.diagnose.experiment_design.propose import propose
from bench.diagnose.experiment_design.undetectable import undetectable_effects
from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import causes_of, unseen_of
from bench.diagnose.linearise.linearised_model import LinearisedModel, linearised_model_of
from bench.diagnose.linearise.signatures import Signatures
from bench.diagnose.name.beside_unlisted import beside_unlisted
from bench.diagnose.name.discrepancy import Discrepancy, discrepancy_of
from bench.diagnose.name.naming import Naming
from bench.diagnose.name.neighbourhood import Neighbourhood
from bench.diagnose.name.selection import name_cause
from bench.diagnose.replay.given import EARLIER, Posterior, given_by, rows_of, with_earlier
from bench.diagnose.replay.known import known_quantities, with_known_payload, with_known_segments
from bench.diagnose.replay.levels import with_recordings
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import MOST_BINS, Segment, segments_of
from bench.diagnose.verdict import Proposal, UndetectableEffect, Unfinished, Verdict
from bench.effects.effect import Effect
from bench.effects.recorded import Recorded, recorded_in
from bench.errors import NOT_SIMULATED, BenchError, InputError
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.executor.watched import Check, Stopped, Watched, never
from bench.identify.dynamics.first_pass import FirstPass
from bench.identify.dynamics.held_out import SAME
from bench.record.campaign import Campaign
from bench.record.carried import with_payloads
from bench.robot.compiled import CompiledRobot
from bench.store.store import Store

UNKNOWN_MASS = 1.0  # derived: relative uncertainty of a mass that nobody knows: none is one standard deviation away
FALSE_ALARM_RATE = 0.01  # declared: of the whole catalogue at once, where the caller declares no other


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """A verdict with all that it rests on."""

    linear: LinearisedModel
    naming: Naming
    verdict: Verdict
    discrepancy: Discrepancy | None = None

    @cached_property
    def extension(self) -> Fit | None:
        """The model with what was found, listed or learned; None where there is nothing to add."""
        return extension_of(self.naming, self.discrepancy)


def extension_of(naming: Naming, discrepancy: Discrepancy | None) -> Fit | None:
    """Return the model with what was found, listed or learned; None where there is nothing to add."""
    if discrepancy and discrepancy.is_gain:
        return discrepancy.fit
    best = naming.models[0] if naming.models else None
    if best is None or not best.causes:
        return None
    if best.shape is None:
        return best.fit
    beside = best.listed_fit(naming.linear)  # what was fitted beside a shape that is not handed over
    alone = refit(naming.linear, beside.causes, beside.start, beside.nuisances, beside)
    return with_jackknife(naming.linear, alone)


def diagnose(
    campaign: Campaign,
    compiled: CompiledRobot,
    catalogue: Mapping[str, Effect],
    rate: float = FALSE_ALARM_RATE,
    progress: Callable[[str], None] = lambda words: None,
    signatures: Signatures | None = None,
    most_bins: int = MOST_BINS,
    proposes: bool = True,
    executor: Executor = SERIAL,
    check: Check = never,
    store: Store | None = None,
    given: Posterior | None = None,
    first: FirstPass | None = None,
) -> Diagnosis:
    """Say what the nominal model gets wrong about a campaign.

    Args:
        campaign: A checked campaign.
        compiled: Its robot, nominal.
        catalogue: Effects to look for.
        rate: Share of null campaigns in which anything at all may be found.
        progress: Called with what is done next.
        signatures: Of other campaigns of the same session, if there were any; from `signatures_of`.
        most_bins: How many bins the motion of one run may have.
        proposes: Whether to look for the next experiment, and for what the campaign could not show.
        executor: Where to simulate; results do not depend on it.
        check: Called between steps and between simulations. It may raise `Stopped`, and the diagnosis ends with what it
            has found so far.
        store: Where signatures are kept between processes; None: nowhere. Not used with `signatures`.
        given: What the diagnosis knew that handed this robot over.
        first: The first pass over the campaign, which the diagnosed model is held against; from `first_look`.

    Raises:
        InputError: The campaign has nothing that a replay predicts.
        CampaignError: What the campaign says that the lab knows besides does not fit the robot.
        ConvergenceError: The nominal model finds no balance along the measured motion.
        Stopped: Before anything was weighed.
        ValueError: Signatures of another kind of session.
    """
    campaign = with_payloads(campaign)
    with threadpool_limits(1, "blas"):  # the matrices are small: threads take more than twice the time
        phases = _Phases(progress, check)
        watched = Watched(executor, check)
        own = signatures_of(campaign, compiled, catalogue, store, given)
        if signatures is not None and signatures.asked != own.asked:
            raise ValueError(
                "these signatures are of other channels or other causes than this campaign and catalogue have"
            )
        task = _Task(campaign, compiled, catalogue, rate, phases, most_bins, watched, first)
        found = _explained(task, signatures or own)
        if found.baseline and found.baseline.lags and not found.unfinished:
            found = _beside_unknown_links(
                task, found, lambda robot: signatures_of(campaign, robot, catalogue, store, given)
            )
        return _concluded(task, found, proposes=proposes)


class _Phases:
    """Tells what is done next, and remembers it; between two phases the work may be stopped."""

    def __init__(self, progress: Callable[[str], None], check: Check) -> None:
        self._progress, self._check = progress, check
        self.now = ""

    def __call__(self, words: str) -> None:
        self._check()
        self.now = words
        self._progress(words)


@dataclass(frozen=True, eq=False)
class _Task:
    """What is asked, as of `diagnose`."""

    campaign: Campaign
    compiled: CompiledRobot
    catalogue: Mapping[str, Effect]
    rate: float
    progress: _Phases
    most_bins: int
    executor: Executor
    first: FirstPass | None


@dataclass(frozen=True, eq=False)
class _Explained:
    """What explains a campaign.

    Attributes:
        signatures: That were weighed.
        segments: Of the campaign.
        naming: What was found.
        about: The campaign linearised about it.
        discrepancy: What became of what is not listed.
        gain: Of the model on what was held out.
        baseline: The model beside least squares.
        unfinished: Why it ended before it was done.
    """

    signatures: Signatures
    segments: tuple[Segment, ...]
    naming: Naming
    about: LinearisedModel
    discrepancy: Discrepancy | None = None
    gain: HeldOut | None = None
    baseline: Baseline | None = None
    unfinished: Unfinished | None = None

    @property
    def fit(self) -> Fit:
        """The model with what was found."""
        return extension_of(self.naming, self.discrepancy) or self.naming.null


def _explained(task: _Task, signatures: Signatures) -> _Explained:
    campaign, compiled, progress = task.campaign, signatures.compiled, task.progress
    quantities = signatures.quantities
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
    around = Neighbourhood(compiled, task.catalogue, measured_by(campaign), task.rate, task.executor, recorded=recorded)
    linear, screening = around.weighed(linear, signatures.causes, sensitivities)
    naming = name_cause(linear, screening, around.about, progress, task.executor)
    found = _Explained(signatures, segments, naming, naming.linear)
    try:
        if naming.stopped:
            raise Stopped(naming.stopped)
        if naming.unlisted:
            progress("learning what is not listed")
            discrepancy = discrepancy_of(naming)
            naming = beside_unlisted(naming, discrepancy)
            about = discrepancy.linear if discrepancy and discrepancy.is_gain else naming.linear
            found = replace(found, naming=naming, discrepancy=discrepancy, about=about)
        if extension := extension_of(naming, found.discrepancy):
            progress("gain on what was held out")
            null = naming.null if found.about is naming.linear else refit(found.about, (), {})
            found = replace(found, gain=held_out(found.about, null, extension))
        if task.first:
            progress("least squares beside it")
            with suppress(np.linalg.LinAlgError):  # without a part of the data, its equations may be singular
                baseline = baseline_of(found.about, extension or naming.null, task.first, task.rate)
                found = replace(found, baseline=baseline)
    except Stopped as stopped:
        found = replace(found, unfinished=unfinished_of(naming, str(stopped), progress.now))
    return found


def _beside_unknown_links(
    task: _Task, found: _Explained, signatures_about: Callable[[CompiledRobot], Signatures]
) -> _Explained:
    """Return what explains a campaign if nobody knew how the links weigh, where that predicts torques better.

    Least squares, which believes nothing of what is stated, predicted better: then masses, centres of mass and moments
    of inertia may be off everywhere by more than is stated, which is no list of single causes.
    """
    task.progress("once more, with links as good as unknown")
    uncertainty = task.compiled.robot.figures.uncertainty
    if not 0 < uncertainty.links * uncertainty.mass < UNKNOWN_MASS:
        return found
    figures = task.compiled.robot.figures.model_copy(
        update={"uncertainty": uncertainty.model_copy(update={"links": UNKNOWN_MASS / uncertainty.mass})}
    )
    compiled = replace(task.compiled, robot=replace(task.compiled.robot, figures=figures))
    try:
        other = _explained(task, signatures_about(compiled))
    except Stopped as stopped:
        return replace(found, unfinished=unfinished_of(found.naming, str(stopped), task.progress.now))
    except NOT_SIMULATED:
        return found
    if other.unfinished:
        return replace(found, unfinished=other.unfinished)
    assert found.baseline
    return other if other.baseline and other.baseline.over(found.baseline) < 1 / SAME else found


def _concluded(task: _Task, found: _Explained, *, proposes: bool) -> Diagnosis:
    """Return the verdict, with what to measure next and what could not be seen."""
    naming, signatures, executor = found.naming, found.signatures, task.executor
    proposals: tuple[Proposal, ...] = ()
    predicted: tuple[PredictedError, ...] = ()
    blind: tuple[UndetectableEffect, ...] = ()
    unfinished = found.unfinished
    try:
        if proposes and not unfinished:
            predicted = predicted_error(found.about, found.fit)
            if naming.models:
                task.progress("the next experiment")
                with suppress(BenchError):  # an explanation that finds no balance elsewhere proposes nothing
                    fits = [one.listed_fit(naming.linear) for one in naming.alternatives]
                    proposals = propose(naming.linear, fits, executor)
            task.progress("what this campaign could not show")
            about = (signatures.compiled, found.segments, signatures.quantities, naming.screening, signatures.causes)
            blind = undetectable_effects(*about, executor)
    except Stopped as stopped:
        unfinished = unfinished_of(naming, str(stopped), task.progress.now)
    missing = unseen_of(task.catalogue.values(), measured_by(task.campaign))
    verdict = verdict_of(naming, task.rate, missing, signatures.unbalanced, found.gain, proposals, found.discrepancy)
    links = (one.robot.figures.uncertainty.links for one in (signatures.compiled, task.compiled))
    verdict = replace(verdict, blind=blind, predicted=predicted, unfinished=unfinished, baseline=found.baseline)
    return Diagnosis(found.about, naming, replace(verdict, links=next(links) / next(links)), found.discrepancy)


def signatures_of(
    campaign: Campaign,
    compiled: CompiledRobot,
    catalogue: Mapping[str, Effect],
    store: Store | None = None,
    given: Posterior | None = None,
) -> Signatures:
    """Return the signatures of a campaign and of all others of its session; nothing is simulated yet."""
    quantities = (*quantities_of(campaign.runs, compiled), *known_quantities(campaign, compiled))
    nuisances = nuisances_of(compiled, quantities)
    if given:
        nuisances = given_by(given, nuisances, compiled).nuisances
        quantities = (*quantities, EARLIER) if rows_of(nuisances) else quantities
    causes = causes_of(catalogue.values(), compiled, measured_by(campaign), recorded_by(campaign, compiled))
    nuisances = with_known_payload(with_recordings(nuisances, compiled, campaign.recordings), campaign, compiled)
    return Signatures(compiled, quantities, nuisances, causes, store=store)


def measured_by(campaign: Campaign) -> frozenset[str]:
    """Return the quantities of a campaign, without numbers and units."""
    names = {name for run in campaign.runs for name in run.columns}
    words = (name.split("_")[:-1] for name in names)
    return frozenset("_".join(word for word in part if not word.isdigit()) for part in words)


def recorded_by(campaign: Campaign, compiled: CompiledRobot) -> Recorded:
    """Return the runs and columns of a campaign, where errors of its recording may sit."""
    return recorded_in(campaign.runs, compiled.model.opt.gravity)
