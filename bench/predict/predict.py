"""A model against a campaign, without a refit: what it leaves, beside the nominal robot, noise and promises.

What may be anew in a recording, by what it leaves, is said beside that.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
from threadpoolctl import threadpool_limits

from bench.diagnose.cross_validation.floor import floor_variance, measured
from bench.diagnose.cross_validation.predicted_error import PredictedError
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.replay.known import known_quantities, with_known_payload, with_known_segments
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.posterior import Posterior
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import NOMINAL
from bench.errors import NOT_SIMULATED, InputError
from bench.predict.another_payload import CARRIED_MASS, carried_by
from bench.predict.errors import channel_errors, worst_stretches
from bench.predict.fit_anew import freed_beside_the_day
from bench.predict.free import checked
from bench.predict.freed import FreedFigure, beside_model, known_of
from bench.predict.model_errors import ModelErrors, model_errors
from bench.predict.prediction import SEEN, ChannelError, MaybeAnew, PredictedRecording, Prediction
from bench.predict.worth_freeing import worth_freeing
from bench.record.campaign import Array, Campaign
from bench.record.carried import with_payloads
from bench.robot.compiled import CompiledRobot

UNMOVED = 1e-6  # rounding: of what no model can predict, by which a fit of something else moves a channel


def predict(
    campaign: Campaign,
    model: CompiledRobot,
    nominal: CompiledRobot,
    promises: Sequence[PredictedError] = (),
    free: Sequence[str] = (),
    posterior: Posterior | None = None,
    progress: Callable[[str], None] = lambda words: None,
) -> Prediction:
    """Hold a model against every recording of a campaign; nothing about one recording depends on the others.

    Args:
        campaign: A checked campaign.
        model: The robot that predicts.
        nominal: The robot to compare it with.
        promises: What the model promises of a recording.
        free: Names of what may be anew in each recording, from `FREE`; it is fitted, and nothing else.
        posterior: What the model's diagnosis knew of it; None: what is free is fitted as if the rest were exact.
        progress: Called with what is done next.

    Raises:
        InputError: A recording has nothing that a replay predicts, or nothing that shows what is free.
        ConvergenceError: The model finds no balance along the measured motion.
    """
    names = checked(free)
    found = []
    with threadpool_limits(1, "blas"):  # the matrices are small: threads take more than twice the time
        for name in campaign.recordings:
            progress(f"predicting {name}".rstrip())
            runs = tuple(run for run in campaign.runs if run.recording == name)
            known = tuple(one for one in campaign.known if one.recording in ("", name))
            one = replace(campaign, runs=runs, known=known)
            found.append(_recording(name, one, model, nominal, promises, names, posterior))
    figures = model.robot.figures
    carried, as_in = carried_by(model)[CARRIED_MASS], figures.fitted.recording
    return Prediction(figures.titled, nominal.robot.name, names, tuple(found), carried, as_in)


def _recording(
    name: str,
    recording: Campaign,
    model: CompiledRobot,
    nominal: CompiledRobot,
    promises: Sequence[PredictedError],
    free: Sequence[str],
    posterior: Posterior | None,
) -> PredictedRecording:
    stated = _linearised(name, recording, model, nominal)
    there = measured(stated)
    noise = np.sqrt(floor_variance(stated))
    nominal_error = np.where(there, _left_by(nominal, stated), np.nan)
    linear, world, left = stated, NOMINAL, stated.residual
    errors = model_errors(stated, posterior) if posterior else None
    freed, untold = tuple[FreedFigure, ...](), tuple[str, ...]()
    if free:
        anew, has = freed_beside_the_day(stated, free), known_of(model)
        linear, world, left = anew.linear, anew.world, anew.residual
        rows = anew.figures(errors)
        freed = tuple(beside_model(figure, in_all, has) for figure, in_all in rows if figure.is_told)
        untold = tuple(figure.name for figure, _ in rows if not figure.is_told)
    error = np.where(there, left, np.nan)
    moved = np.nan_to_num(np.abs(left - stated.residual) / np.where(there, noise, np.inf))
    is_fitted = np.max(moved, axis=0, initial=0.0) > UNMOVED
    channels = channel_errors(linear, error, nominal_error, noise, promises, is_fitted)
    starts = {run.name: run.start_s for run in recording.runs}
    return PredictedRecording(
        name=name,
        linear=linear,
        world=world,
        error=error,
        nominal_error=nominal_error,
        noise=noise,
        freed=freed,
        is_exact=posterior is None,
        untold=untold,
        maybe_anew=tuple(_maybe_anew(stated, free, channels, errors)),
        channels=channels,
        stretches=worst_stretches(linear, error, noise, starts),
        starts=starts,
    )


def _linearised(name: str, recording: Campaign, model: CompiledRobot, nominal: CompiledRobot) -> LinearisedModel:
    """Return a recording, linearised about the model.

    Raises:
        InputError: It has nothing that a replay predicts.
    """
    recording = with_payloads(recording)
    quantities = (*quantities_of(recording.runs, model), *known_quantities(recording, model))
    # cut as the diagnosis cut what its promises rest on: bins are as long as the nominal robot rings
    segments = with_known_segments(segments_of(recording, nominal, quantities), recording, model, quantities)
    if not segments or not quantities:
        raise InputError(
            f"recording {name or recording.runs[0].name}: has no channel that a replay predicts: log motor currents or "
            "torques, a reflector, a link encoder, or the gas pressure, beside the motor angles."
        )
    return linearised_model_of(
        Replay(model, segments, quantities), with_known_payload(nuisances_of(model, quantities), recording)
    )


def _maybe_anew(
    stated: LinearisedModel, free: Sequence[str], channels: Sequence[ChannelError], errors: ModelErrors | None
) -> Iterator[MaybeAnew]:
    """Yield what is worth freeing and lowers the error of a channel, the likeliest first.

    Args:
        stated: The recording, linearised about the model as it stands.
        free: What is free already.
        channels: What the model leaves with that.
        errors: Of the model; None: it is taken as exact.
    """
    nothing = np.full_like(stated.residual, np.nan)

    @cache
    def left_with(*freed: str) -> tuple[float, ...]:
        left = np.where(measured(stated), freed_beside_the_day(stated, freed).residual, np.nan)
        return tuple(channel.rms for channel in channel_errors(stated, left, nothing, nothing, ()))

    for one in worth_freeing(stated, free, errors):
        before = left_with(*free, *one.beside) if one.beside else tuple(channel.rms for channel in channels)
        with_it = left_with(*free, *one.beside, one.name)
        if any(then < (1 - SEEN) * now for now, then in zip(before, with_it, strict=True)):
            yield MaybeAnew(one.name, one.log_evidence, before, with_it, one.beside)


def _left_by(nominal: CompiledRobot, linear: LinearisedModel) -> Array:
    """Return measured less what the nominal robot predicts, shape (T, c); nan where it finds no balance."""
    try:
        return linear.observed - Replay(nominal, linear.segments, linear.quantities).predict(NOMINAL)
    except NOT_SIMULATED:
        return np.full_like(linear.residual, np.nan)
