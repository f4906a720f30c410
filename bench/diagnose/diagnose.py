"""From a campaign to a naming: replay, screen, refit. `bench.report.handover` writes the robot that is handed over."""

from collections.abc import Callable, Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace

from threadpoolctl import threadpool_limits

from bench.diagnose.conclude import named_cause, unfinished_of, verdict_of
from bench.diagnose.cross_validation.figures import changed_figures
from bench.diagnose.cross_validation.next_recording import predicted_error
from bench.diagnose.cross_validation.predicted_error import PredictedError
from bench.diagnose.experiment_design.propose import propose
from bench.diagnose.experiment_design.undetectable import undetectable_beside, undetectable_effects
from bench.diagnose.explain import (
    Explained,
    Phases,
    Task,
    beside_unknown_links,
    beyond_plausible,
    explained,
    is_open,
    measured_by,
    recorded_by,
)
from bench.diagnose.extend.fit import Fit
from bench.diagnose.extension import extension_of
from bench.diagnose.linearise.candidates import causes_of, unseen_of
from bench.diagnose.linearise.contradicted import contradicted_readings
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.signatures import Signatures
from bench.diagnose.name.beginning import told_by
from bench.diagnose.name.discrepancy import Discrepancy
from bench.diagnose.name.naming import Naming
from bench.diagnose.replay.given import EARLIER, Posterior, given_by, rows_of
from bench.diagnose.replay.known import known_quantities, with_known_payload
from bench.diagnose.replay.levels import with_recordings
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.segments import MOST_BINS
from bench.diagnose.replay.slow_motion import slow_motion
from bench.diagnose.verdict import Proposal, UndetectableEffect, Verdict
from bench.effects.effect import Effect
from bench.errors import BenchError
from bench.executor.contract import Executor
from bench.executor.serial import SERIAL
from bench.executor.watched import Check, Stopped, Watched, never
from bench.identify.dynamics.found import FirstPass
from bench.record.campaign import Campaign
from bench.record.carried import with_payloads
from bench.robot.compiled import CompiledRobot
from bench.store.store import Store

FALSE_ALARM_RATE = 0.01  # declared: of the whole catalogue at once, where the caller declares no other


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """A verdict with all that it rests on.

    Attributes:
        linear: The campaign linearised about what was found.
        naming: What the data say.
        verdict: The same for people.
        discrepancy: What became of what is not listed.
        extension: The model with what was found, listed or learned; None where there is nothing to add.
    """

    linear: LinearisedModel
    naming: Naming
    verdict: Verdict
    discrepancy: Discrepancy | None = None
    extension: Fit | None = None


def diagnose(
    campaign: Campaign,
    compiled: CompiledRobot,
    catalogue: Mapping[str, Effect],
    rate: float = FALSE_ALARM_RATE,
    progress: Callable[[str], None] = lambda words: None,
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
        most_bins: How many bins the motion of one run may have.
        proposes: Whether to look for the next experiment, and for what the campaign could not show.
        executor: Where to simulate; results do not depend on it.
        check: Called between steps and between simulations. It may raise `Stopped`, and the diagnosis ends with what it
            has found so far.
        store: Where signatures are kept between processes; None: nowhere.
        given: What the diagnosis knew that handed this robot over.
        first: The first pass over the campaign, which the diagnosed model is held against; from `first_look`.

    Raises:
        InputError: The campaign has nothing that a replay predicts.
        CampaignError: What the campaign says that the lab knows besides does not fit the robot.
        ConvergenceError: The nominal model finds no balance along the measured motion.
        Stopped: Before anything was weighed.
    """
    campaign = with_payloads(campaign)
    with threadpool_limits(1, "blas"):  # the matrices are small: threads take more than twice the time
        phases = Phases(progress, check)
        watched = Watched(executor, check)
        task = Task(campaign, compiled, catalogue, rate, phases, most_bins, watched, first)
        told = told_by(first)
        found = explained(task, signatures_of(campaign, compiled, catalogue, store, given, told))
        if found.baseline and found.baseline.lags and not found.unfinished:
            found = beside_unknown_links(
                task, found, lambda robot: signatures_of(campaign, robot, catalogue, store, given, told)
            )
        if is_open(found):
            found = beyond_plausible(task, found)
        return _concluded(task, found, proposes=proposes)


def _concluded(task: Task, found: Explained, *, proposes: bool) -> Diagnosis:
    """Return the verdict, with what to measure next and what could not be seen."""
    # which an unfinished one does not have yet
    found = replace(found, extension=found.extension or extension_of(found.naming, found.discrepancy))
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
            blind = undetectable_effects(*about, executor, naming.found, naming.linear)
            with suppress(BenchError):  # a model that finds no balance with another instrument
                world = found.fit.world(found.about)
                blind += undetectable_beside(*about[:3], naming, signatures.causes, world, executor)
    except Stopped as stopped:
        unfinished = unfinished_of(naming, str(stopped), task.progress.now)
    missing = unseen_of(task.catalogue.values(), measured_by(task.campaign))
    verdict = verdict_of(naming, task.rate, missing, signatures.unbalanced, found.gain, proposals, found.discrepancy)
    if verdict.unlisted:
        instead = tuple(named_cause(cause, found.fit) for cause in found.stand_ins)
        verdict = replace(verdict, unlisted=replace(verdict.unlisted, stand_ins=instead))
    links = (one.robot.figures.uncertainty.links for one in (signatures.compiled, task.compiled))
    verdict = replace(verdict, blind=blind, predicted=predicted, unfinished=unfinished, baseline=found.baseline)
    slow = slow_motion(found.about.segments, found.about.quantities, found.about.replay.compiled.is_slide)
    contradicted = tuple(contradicted_readings(naming.linear, found.fit.residual))
    verdict = replace(verdict, changed=changed_figures(found.about, found.fit), slow=slow, contradicted=contradicted)
    verdict = replace(verdict, links=next(links) / next(links))
    return Diagnosis(found.about, naming, verdict, found.discrepancy, found.extension)


def signatures_of(
    campaign: Campaign,
    compiled: CompiledRobot,
    catalogue: Mapping[str, Effect],
    store: Store | None = None,
    given: Posterior | None = None,
    told: Collection[tuple[str, int]] = (),
) -> Signatures:
    """Return the signatures of a campaign; nothing is simulated yet.

    Args:
        campaign: What was recorded.
        compiled: The robot.
        catalogue: Effects.
        store: Where signatures are kept between processes; None: nowhere.
        given: What is known from before.
        told: What a first pass has: names of effects, each with the index of its drive.
    """
    quantities = (*quantities_of(campaign.runs, compiled), *known_quantities(campaign, compiled))
    nuisances = nuisances_of(compiled, quantities)
    if given:
        nuisances = given_by(given, nuisances, compiled).nuisances
        quantities = (*quantities, EARLIER) if rows_of(nuisances) else quantities
    measured, recorded = measured_by(campaign), recorded_by(campaign, compiled)
    causes = causes_of(catalogue.values(), compiled, measured, recorded, told=told)
    nuisances = with_known_payload(with_recordings(nuisances, compiled, campaign.recordings), campaign)
    return Signatures(compiled, quantities, nuisances, causes, store=store)
