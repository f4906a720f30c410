"""The linearised model of a campaign about the nominal robot: where everything else begins."""

from dataclasses import replace

import numpy as np

from bench.diagnose.linearise.each_weight import each_weight
from bench.diagnose.linearise.held_friction import held_friction, levels_of
from bench.diagnose.linearise.linearised_model import LinearisedModel, assembled
from bench.diagnose.linearise.noise_covariance import Scatter
from bench.diagnose.linearise.other_noise import roughened, with_places, with_scatter
from bench.diagnose.linearise.repeated_rests import repeating_share
from bench.diagnose.linearise.standing_joints import shaken_share
from bench.diagnose.linearise.torque_response import torque_response
from bench.diagnose.replay.instants import instants_of
from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.simulations import simulate_all, sound
from bench.diagnose.replay.world import NOMINAL, World
from bench.record.campaign import Array


def linearised_model_of(
    replay: Replay, nuisances: tuple[Nuisance, ...], sensitivities: Array | None = None
) -> LinearisedModel:
    """Return the linearised model of a campaign.

    Args:
        replay: The campaign with the nominal robot.
        nuisances: What may be a little wrong.
        sensitivities: Shape (T, c, p), if they are known from a campaign of the same design.
    """
    nominal = replay.predict(NOMINAL)
    if sensitivities is None:
        worlds = [World({nuisance: nuisance.sigma}) for nuisance in nuisances]
        sensitivities = np.stack([sound(found) - nominal for found in simulate_all(replay, worlds)], axis=2)
    residual = replay.observed - nominal
    traces = replay.traces(NOMINAL)
    responses = tuple(torque_response(replay.compiled, trace, replay.quantities) for trace in traces)
    levels = levels_of(replay.compiled)
    held, held_changes = held_friction(replay, traces, responses, levels)
    weights, their_changes = each_weight(replay.segments, nuisances, sensitivities)
    nuisances = (*nuisances, *held, *weights)
    sensitivities = np.concatenate([sensitivities, held_changes, their_changes], axis=2)
    parts = [residual[rows] for rows in instants_of(replay.segments)]
    shaken = shaken_share(replay.compiled, replay.segments, responses, replay.quantities, parts)
    scatter = Scatter(replay.compiled.play, levels, shaken)
    plain = assembled(replay, nuisances, responses, scatter, replay.segments, sensitivities, residual)
    parts = plain.split(residual - plain.sensitivities @ plain.most_probable(plain.white))
    repeats = repeating_share(replay.compiled, replay.segments, responses, replay.quantities, scatter, parts)
    plain = with_scatter(plain, replace(scatter, repeats=repeats)) if repeats else plain
    # What rings after a jerk is left out of the replay: where residuals are rough then, roughness is the noise.
    rings = [segment.rings for segment in replay.segments]
    found = roughened(plain, residual - plain.sensitivities @ plain.most_probable(plain.white), rings)
    return with_places(found, found.residual)
