"""Zeros of motor encoders: within what is stated of them they are figures, beyond it a finding."""

from dataclasses import replace

import numpy as np
import pytest

from bench.compare.levels import EVERY, by_level, is_of_machine
from bench.diagnose.diagnose import diagnose
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.replay.levels import with_recordings
from bench.diagnose.replay.nuisances import MOTOR_ZERO, Nuisance, nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import World
from bench.effects.catalogue import catalogue
from bench.effects.drifts import own_shares
from bench.effects.effect import Acting
from bench.hide.campaign import hide_campaign
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.robot.instruments import Encoder
from bench.scenario.files import read_scenario
from tests.diagnose.sweeps import LOADS, made

STATED = 2e-4  # [rad]
ZERO = catalogue()["joint_zero"]


def stating(sigma: float, zeroing: float = 0.0) -> CompiledRobot:
    """Return the HH-150 with zeros of its motors that are known so well, and are found anew so well each day."""
    robot = load_robot("hh150")
    encoder = Encoder(offset_sigma_rad=sigma, zeroing_sigma_rad=zeroing)
    instruments = robot.figures.instruments.model_copy(update={"encoder": encoder})
    return compile_robot(replace(robot, figures=robot.figures.model_copy(update={"instruments": instruments})))


def zeros_of(compiled: CompiledRobot, campaign: Campaign) -> list[Nuisance]:
    every = nuisances_of(compiled, quantities_of(campaign.runs, compiled))
    return [one for one in every if one.name.startswith(MOTOR_ZERO)]


@pytest.fixture(scope="module")
def loads() -> Campaign:
    return made(LOADS, seed=5)


def test_each_motor_has_one_as_well_as_it_is_stated(loads: Campaign) -> None:
    assert zeros_of(stating(0.0), loads) == []
    zeros = zeros_of(stating(STATED), loads)
    assert [(one.encoder, one.sigma, one.unit) for one in zeros] == [(j, STATED, "rad") for j in range(6)]
    both = with_recordings(zeros, stating(STATED), ("may", "june"))
    assert [(one.recording, one.sigma) for one in both if one.encoder is not None] == [
        (None, STATED)
    ] * 6  # they stay as they are
    assert all(is_of_machine(one) for one in zeros)


def test_drives_that_are_homed_anew_have_another_zero_each_day(loads: Campaign) -> None:
    """On a stranger's arm all seven moved by 0.01 degrees, and `compare` named the zero of one joint for them."""
    compiled = stating(STATED, 0.6 * STATED)
    both = with_recordings(zeros_of(compiled, loads), compiled, ("may", "june"))
    of_first = [(one.recording, one.sigma) for one in both if one.encoder == 0]
    assert of_first == [
        (None, pytest.approx(0.8 * STATED)),
        ("may", pytest.approx(0.6 * STATED)),
        ("june", pytest.approx(0.6 * STATED)),
    ]
    assert own_shares(compiled.robot.figures)["encoder_offset"] == pytest.approx(0.36)
    linear = linearised_model_of(
        Replay(
            compiled,
            segments_of(loads, compiled, quantities_of(loads.runs, compiled), 60),
            quantities_of(loads.runs, compiled),
        ),
        zeros_of(compiled, loads),
    )
    half = np.arange(len(linear.white)) >= len(linear.white) // 2
    slopes = by_level(linear.jacobian, linear.nuisances, half.astype(np.intp), 1.0)
    of_days = slopes.matrix[:, (slopes.nuisance == 0) & (slopes.recording != EVERY)]
    assert of_days.shape[1] == 2
    np.testing.assert_allclose(of_days.sum(axis=1), 0.6 * linear.jacobian[:, 0])


def test_it_does_what_a_zero_that_is_hidden_does(loads: Campaign) -> None:
    compiled = stating(STATED)
    quantities = quantities_of(loads.runs, compiled)
    replay = Replay(compiled, segments_of(loads, compiled, quantities), quantities)
    zero = zeros_of(compiled, loads)[4]
    figure = replay.predict(World({zero: 1e-3}))
    effect = replay.predict(World(acting=(Acting(ZERO, ZERO.places(compiled)[4], {"offset": 1e-3}),)))
    np.testing.assert_array_equal(figure, effect)
    assert np.nanmax(np.abs(figure - replay.predict(World()))) > 1e-4


@pytest.mark.parametrize(
    ("off", "stated", "is_found"),
    [(4e-4, STATED, False), pytest.param(4e-4, 0.0, True, marks=pytest.mark.study), (1.7e-3, STATED, True)],
)
def test_only_what_is_beyond_its_stated_uncertainty_is_found(off: float, stated: float, is_found: bool) -> None:
    """A zero of 0.43 mrad, stated to 0.2, was a finding at 98 %: no figure could hold it."""
    compiled, session = stating(stated), read_scenario("session-short")
    acting = Acting(ZERO, ZERO.places(compiled)[4], {"offset": off})
    campaign = hide_campaign(load_robot("hh150"), session, [acting], np.random.default_rng(3)).campaign
    choice = {name: catalogue()[name] for name in ("joint_zero", "link_length", "tracker_frame", "joint_compliance")}
    named = diagnose(campaign, compiled, choice, proposes=False).verdict.explanations
    assert [(cause.effect, cause.place) for one in named[:1] for cause in one.causes] == (
        [("joint_zero", "joint 5")] if is_found else []
    )
