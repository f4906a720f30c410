"""Days of a sound robot as instruments without any error read them: what a replay leaves of them is its own."""

from dataclasses import replace

import numpy as np

from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.replay.levels import with_recordings
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.effects.recorded import recorded_in
from bench.hide.campaign import Hidden, hide_campaign
from bench.record.campaign import Campaign
from bench.record.carried import with_payloads
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.scenario.files import read_scenario


def noise_free(scenario: str, seed: int = 4, acting: tuple[Acting, ...] = ()) -> Campaign:
    """Return a session of the HH-150, in which nothing acts but `acting`."""
    hidden = simulated(scenario, seed, acting)
    truth = hidden.truth.runs
    runs = tuple(
        replace(run, columns={key: truth[run.name].get(key, values) for key, values in run.columns.items()})
        for run in hidden.campaign.runs
    )
    return replace(hidden.campaign, runs=runs)


def simulated(scenario: str, seed: int = 4, acting: tuple[Acting, ...] = ()) -> Hidden:
    """Return a session of the HH-150 with noise, in which nothing else acts but `acting`, and the truth beside it."""
    rng = np.random.default_rng(seed)
    return hide_campaign(load_robot("hh150"), read_scenario(scenario), acting, rng, background=False)


def linearised(campaign: Campaign, compiled: CompiledRobot | None = None) -> LinearisedModel:
    """Return its linearised model, with the noise that the robot's figures state; of the nominal robot or another."""
    campaign = with_payloads(campaign)
    compiled = compiled or compile_robot(load_robot(campaign.robot))
    quantities = quantities_of(campaign.runs, compiled)
    nuisances = with_recordings(nuisances_of(compiled, quantities), compiled, campaign.recordings)
    return linearised_model_of(Replay(compiled, segments_of(campaign, compiled, quantities), quantities), nuisances)


def fitted_alone(linear: LinearisedModel, campaign: Campaign, name: str, place: str, **start: float) -> Fit:
    """Return the fit of one effect at a place, from values of its parameters."""
    compiled, effect = linear.replay.compiled, catalogue()[name]
    recorded = recorded_in(campaign.runs, compiled.model.opt.gravity)
    (where,) = (one for one in effect.places_in(compiled, recorded) if str(one) == place)
    known = {(name, str(where), key): value for key, value in start.items()}
    return refit(linear, (Cause(effect, where, effect.parameters_at(compiled, where), ()),), known)
