"""A replay of a sound robot, read without noise, finds its torques neither early nor late."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel, linearised_model_of
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.effects.catalogue import catalogue
from bench.effects.recorded import recorded_in
from bench.hide.campaign import hide_campaign
from bench.record.campaign import Run
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.scenario.files import read_scenario


@pytest.fixture(scope="module")
def ideal() -> tuple[LinearisedModel, tuple[Run, ...]]:
    """Return a lab's day with the HH-150, samples of 20 ms, as instruments without any error read it."""
    robot = load_robot("hh150")
    session = read_scenario("session-study")
    hidden = hide_campaign(robot, session, (), np.random.default_rng(4), background=False)
    truth = hidden.truth.runs
    runs = tuple(
        replace(run, columns={key: truth[run.name].get(key, values) for key, values in run.columns.items()})
        for run in hidden.campaign.runs
    )
    compiled = compile_robot(robot)
    quantities = quantities_of(runs, compiled)
    segments = segments_of(replace(hidden.campaign, runs=runs), compiled, quantities)
    return linearised_model_of(Replay(compiled, segments, quantities), nuisances_of(compiled, quantities)), runs


@pytest.mark.parametrize(
    ("name", "place", "most"), [("drive_delay", "robot", 0.1e-3), ("channel_delay", "current_5_a", 0.25e-3)]
)
def test_torques_are_on_time(
    ideal: tuple[LinearisedModel, tuple[Run, ...]], name: str, place: str, most: float
) -> None:
    """It was 0.2 ms of all drives and 0.7 ms of joint 5: friction was that of the speed in the middle of a bin."""
    linear, runs = ideal
    compiled, effect = linear.replay.compiled, catalogue()[name]
    (where,) = (
        one for one in effect.places_in(compiled, recorded_in(runs, compiled.model.opt.gravity)) if str(one) == place
    )
    fit = refit(linear, (Cause(effect, where, effect.parameters_at(compiled, where), ()),), {})
    print(f"{name} {place}: {1e3 * fit.values[0]:.3f} ms, +- {1e3 * fit.sigma[0]:.2f} ms with the noise of a campaign")
    assert abs(fit.values[0]) < most
