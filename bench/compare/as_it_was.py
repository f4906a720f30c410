"""The robot as the recordings before show it: what a comparison is linear about."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from bench.compare.comparison import Origin
from bench.compare.free_torques import acting_in, beside, free_torques
from bench.diagnose.baseline.first_look import first_look
from bench.diagnose.diagnose import FALSE_ALARM_RATE, diagnose
from bench.diagnose.explain import measured_by, recorded_by
from bench.diagnose.extend.fit import Fit, Key
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import Cause, causes_of
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.linearise.screening import Screening
from bench.diagnose.linearise.signatures import Signatures
from bench.diagnose.name.beginning import what_is_left_out
from bench.diagnose.name.candidate_model import CandidateModel
from bench.diagnose.name.models import Model
from bench.diagnose.name.neighbourhood import Neighbourhood
from bench.diagnose.replay.fitted import figures_with, zeros_in
from bench.diagnose.replay.instants import recordings_of
from bench.diagnose.replay.levels import as_of, with_recordings
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import World, edits_in
from bench.effects.catalogue import LEFT_OUT, catalogue
from bench.effects.conditions import Conditions
from bench.effects.division import divided, payload_as_body
from bench.effects.effect import Effect
from bench.effects.fitted import entry_of
from bench.errors import NOT_SIMULATED
from bench.executor.contract import Executor, Progress, in_order
from bench.executor.serial import SERIAL
from bench.executor.watched import Check, Watched, never
from bench.record.campaign import Campaign
from bench.record.carried import with_payloads
from bench.robot.compiled import CompiledRobot, compile_robot, compile_spec, read_spec
from bench.robot.fitted import Fitted
from bench.robot.folder import load_robot
from bench.robot.write import write_robot
from bench.store.store import Store

MOST_FITS = 4  # effort: each with the derivatives about the one before
SETTLED = 0.5  # effort: log evidence; a fit that rises by less is settled, as in `settle.py`
FITS = 2.0  # declared: times the noise, that stated figures leave of a robot whose drawing leaves nothing out


@dataclass(frozen=True, eq=False)
class AsItWas:
    """The robot as it was before anything changed.

    Attributes:
        robot: With all that was fitted.
        origin: What found that.
    """

    robot: CompiledRobot
    origin: Origin


def as_it_was(
    before: Campaign,
    compiled: CompiledRobot,
    folder: Path,
    effects: Mapping[str, Effect] | None = None,
    *,
    is_handed_over: bool = False,
    progress: Callable[[str], None] = lambda words: None,
    executor: Executor = SERIAL,
    store: Store | None = None,
    check: Check = never,
) -> AsItWas:
    """Return the robot with its figures fitted to what was recorded before, as it was last seen there.

    What drifts from day to day multiplies what the nominal model gets wrong: a torque constant that is another one by
    2 % moves the part of the current that a wrong inertia left over by 2 %, too. Linear about the nominal robot that is
    left out, and was named as a change of inertia. Where figures alone do not fit, friction, a payload and a delay that
    nobody stated are fitted with them, if that is likelier: else torque constants would stand for all friction. Where
    even so not all is explained, a torque over the angle of every joint is fitted with it (`free_torques.py`). Where
    that does not do either, the recordings before are diagnosed, and the robot has all that is found: about a robot
    that is far off, changes have wrong names.

    A robot that a diagnosis handed over has all that the machine has. What it leaves of the noise is what the diagnosis
    could not explain either, so only what may be another one in each recording is asked for, where signatures show it.

    Args:
        before: Recordings of the machine as it was.
        compiled: The robot to begin with; it is returned where no model can be fitted to them.
        folder: For the files of the fitted robot, which have to stay for as long as it is used.
        effects: What a diagnosis looks for; None: the catalogue.
        is_handed_over: Whether a finished diagnosis handed the robot over.
        progress: Called with what is done next.
        executor: Where to simulate; the result does not depend on it.
        store: Where signatures are kept between processes; None: nowhere.
        check: Called before every simulation of a fit; where it raises `Stopped`, there is no such robot.

    Raises:
        Stopped: Before all was fitted.
    """
    progress("the robot as it was")
    origin: Origin = "handed over" if is_handed_over else "fitted"
    campaign = with_payloads(before)
    quantities = quantities_of(campaign.runs, compiled)
    segments = segments_of(campaign, compiled, quantities)
    if not segments:
        return AsItWas(compiled, origin)
    nuisances = with_recordings(nuisances_of(compiled, quantities), compiled, campaign.recordings)
    known = {name: effect for name, effect in catalogue().items() if name in LEFT_OUT}
    if is_handed_over:
        known = {name: effect for name, effect in known.items() if effect.between == "anew"}
    watched = Watched(executor, check)
    measured, recorded = measured_by(campaign), recorded_by(campaign, compiled)
    causes = causes_of([*known.values()], compiled, measured, recorded)
    with threadpool_limits(1, "blas"):  # as all of a comparison: threads would change roundings, and cost time
        try:
            changes = Signatures(compiled, quantities, nuisances, causes).sensitivities(segments, watched)
            linear = linearised_model_of(Replay(compiled, segments, quantities), nuisances, changes.nuisances)
            fit = refit(linear, (), {}, progress=lambda share: check())
            world, left = fit.world(linear), _left(linear, fit)
            if causes and left > FITS:
                around = Neighbourhood(compiled, known, measured, FALSE_ALARM_RATE, watched, recorded)
                weighed, screening = around.weighed(linear, causes, changes)
                if not is_handed_over or _shows(screening):
                    candidate = what_is_left_out(weighed, around.everything(weighed), screening.threshold, Model(fit))
                    may_be_held = not is_handed_over
                    world, left = _with_what_is_left_out(linear, fit, candidate, watched, may_be_held=may_be_held)
            if not is_handed_over and left > FITS:
                progress("a diagnosis of the robot as it was")
                every = catalogue() if effects is None else effects
                found = diagnose(
                    before,
                    compiled,
                    every,
                    progress=progress,
                    proposes=False,
                    executor=executor,
                    check=check,
                    store=store,
                    first=first_look(campaign, compiled).found,
                )
                linear, fit = found.linear, found.extension or found.naming.null
                world, origin = fit.world(linear), "diagnosed"
            last = as_of(world, recordings_of(segments)[-1])
            return AsItWas(_written(linear.replay.compiled, last, folder / "robot"), origin)
        except NOT_SIMULATED:
            return AsItWas(compiled, origin)


def _shows(screening: Screening) -> bool:
    """Whether signatures show any cause beyond chance."""
    return any(entry.cause and entry.log_evidence > screening.threshold for entry in screening.entries)


def _left(linear: LinearisedModel, fit: Fit) -> float:
    """Return what a fit leaves, the root mean square in standard deviations."""
    return float(np.sqrt(np.mean(linear.whiten(fit.residual) ** 2)))


def _with_what_is_left_out(
    linear: LinearisedModel, nominal: Fit, candidate: CandidateModel, executor: Executor, *, may_be_held: bool
) -> tuple[World, float]:
    """Return the likeliest world and what it leaves: with figures alone, with what nobody stated, or held as well.

    Args:
        linear: The campaign.
        nominal: Fit of the figures alone.
        candidate: What nobody stated.
        executor: Where to fit.
        may_be_held: Whether something else may hold the joints, which is asked where even so not all is explained.
    """
    best = max(nominal, _fitted(linear, candidate, executor), key=lambda one: one.log_evidence)
    left = _left(linear, best)
    if not may_be_held or left <= FITS:
        return best.world(linear), left
    torques = free_torques(linear)
    design = beside(linear, torques)
    other = _fitted(design, candidate, executor)
    if other.log_evidence < best.log_evidence:
        return best.world(linear), left
    world = other.world(design)
    world = World(world.deviations, (*world.acting, *acting_in(linear, torques, other)))
    return world, _left(design, other)


def _fitted(linear: LinearisedModel, candidate: CandidateModel, executor: Executor) -> Fit:
    """Return the likeliest fit of figures and causes together, settled.

    Where it begins decides which optimum it ends in, for a first moment without a mass shows nothing: from causes of no
    size, 5 kg half a metre beside a payload of 9 kg, at 76 times the noise; from what signatures say, 0.05 kg in place
    of 3 kg.
    """
    starts: tuple[Mapping[Key, float], ...] = ({}, candidate.start)
    fits = in_order(executor, partial(_settled, linear, candidate.causes), starts)
    return max(fits, key=lambda one: one.log_evidence).with_causes(candidate.causes)


def _settled(linear: LinearisedModel, causes: tuple[Cause, ...], start: Mapping[Key, float], progress: Progress) -> Fit:
    """Return a fit of figures and causes together, settled.

    One that was not put what a payload of 7.3 kg weighs into the centre of mass of the last link, ten standard
    deviations away, and what changed was named as links.
    """
    fit = refit(linear, causes, start, progress=progress)
    for _ in range(MOST_FITS):
        before, fit = fit, refit(linear, causes, fit.start, fit.nuisances, progress=progress)
        if fit.log_evidence - before.log_evidence < SETTLED:
            break
    return fit.with_causes(())


def _written(compiled: CompiledRobot, world: World, folder: Path) -> CompiledRobot:
    """Return the robot of a world, from files in a folder that is made here.

    Raises:
        RobotError: The MJCF does not compile, its files are no longer what they were, or a figure is none.
    """
    robot, spec = compiled.robot, read_spec(compiled.robot)
    acting = divided(compiled, (*world.acting, *zeros_in(world, compiled)))
    edits = edits_in(World(world.deviations, acting.in_model), Conditions.reference(compiled.n_joints))
    compile_spec(spec, robot, [*edits, payload_as_body])
    readings, weights, _ = figures_with(compiled, world.deviations)
    before = robot.figures.fitted
    effects = (*before.effects, *(entry for one in acting.beside if (entry := entry_of(one))))
    more = {"unfinished": before.unfinished, "recording": before.recording}
    fitted = Fitted(readings=readings, weights=weights, effects=effects, **more)
    write_robot(robot, spec, robot.figures.model_copy(update={"fitted": fitted}), folder, "")
    return compile_robot(load_robot(folder))
