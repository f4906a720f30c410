"""Noise in another unit and a known temperature that the thermometer contradicts are told; right ones are not."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.plausibility.known_temperature import known_temperatures
from bench.diagnose.plausibility.single_rows import jumps
from bench.diagnose.plausibility.stated_noise import coarse_encoders, noise_as_stated, rounded_places
from bench.record.campaign import Campaign
from bench.record.known import Known
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.diagnose.sweeps import SWEEP, made
from tests.diagnose.test_one_more_number import session

RIGHT = {"current": 0.03, "reflector": 30e-6, "force": 0.5, "moment": 0.3}
LOGGED_K = 300.0


ROBOT = load_robot("hh150")


@pytest.fixture(scope="module")
def campaign() -> Campaign:
    return session(43)


@pytest.mark.parametrize("quantity", RIGHT)
@pytest.mark.parametrize(("factor", "words"), [(1e3, "times as much as"), (1e-3, "times less than")])
def test_noise_in_another_unit_is_told(campaign: Campaign, quantity: str, factor: float, words: str) -> None:
    (said,) = map(str, noise_as_stated(replace(campaign, noise=RIGHT | {quantity: factor * RIGHT[quantity]}), ROBOT))
    assert f"noise.{quantity}" in said
    assert words in said


@pytest.mark.parametrize("factor", [0.1, 1.0, 10.0])
def test_noise_that_is_stated_with_care_or_without_is_believed(campaign: Campaign, factor: float) -> None:
    stated = {quantity: factor * sigma for quantity, sigma in RIGHT.items()}
    assert not [*noise_as_stated(replace(campaign, noise=stated), ROBOT)]


def test_noise_of_what_was_not_read_is_not_judged(campaign: Campaign) -> None:
    assert not [*noise_as_stated(replace(campaign, noise={"tau_motor": 1e4, "gas_pressure": 1e4}), ROBOT)]


def thermometer(campaign: Campaign, value: float, sigma: float = 1.0, warms: float = 2.0) -> list[str]:
    """Return what is said of a known temperature where a thermometer logs some that rise from run to run."""
    rise = np.linspace(0, warms, len(campaign.runs))
    runs = [
        replace(run, columns={**run.columns, "gas_temperature_k": np.full(len(run), LOGGED_K + more)})
        for run, more in zip(campaign.runs, rise, strict=True)
    ]
    known = (Known("payload_kg", 0, 1), Known("gas_temperature_k", value, sigma))
    return [str(finding) for finding in known_temperatures(replace(campaign, runs=tuple(runs), known=known))]


def test_a_known_temperature_that_the_thermometer_contradicts_is_told(campaign: Campaign) -> None:
    (said,) = thermometer(campaign, LOGGED_K + 40)
    assert "known[1].value" in said
    assert "300 to 302 K" in said


def test_a_known_temperature_that_may_have_been_so_is_believed(campaign: Campaign) -> None:
    assert not thermometer(campaign, LOGGED_K + 8)
    assert not thermometer(campaign, LOGGED_K + 40, sigma=10)
    assert not thermometer(campaign, LOGGED_K + 50, warms=100)
    known = (Known("gas_temperature_k", 400, 1),)
    assert not [*known_temperatures(replace(campaign, known=known))]  # no thermometer


@pytest.mark.parametrize("step", [1e-3, 1e-2])
def test_an_encoder_far_coarser_than_stated_is_told(step: float) -> None:
    """Nothing was said of steps of 1 mrad, and of 10 mrad that rows had been lost."""
    campaign = made(SWEEP, 1)
    assert not [*coarse_encoders(campaign, ROBOT)]
    for run in campaign.runs:
        assert run.kind == "motion"
    name = "q_motor_2_rad"
    coarse = [
        replace(run, columns=dict(run.columns) | {name: np.round(run.columns[name] / step) * step})
        for run in campaign.runs
    ]
    (said,) = coarse_encoders(replace(campaign, runs=tuple(coarse)), ROBOT)
    assert (said.level, said.column) == ("warning", name)
    assert f"steps of {step:g}" in said.message
    assert not [*jumps(replace(campaign, runs=tuple(coarse)), compile_robot(ROBOT))]


@pytest.mark.parametrize(("step", "is_told"), [(1e-5, False), (1e-3, True), (1e-2, True)])
def test_places_that_were_rounded_are_told(campaign: Campaign, step: float, is_told: bool) -> None:
    """In whole millimetres two joints were half as stiff, and intervals did not hold; nothing was said."""
    assert not [*rounded_places(campaign, ROBOT)]
    name = "reflector_1_z_m"
    runs = [
        replace(run, columns=dict(run.columns) | {name: np.round(run.columns[name] / step) * step})
        for run in campaign.runs
    ]
    said = [*rounded_places(replace(campaign, runs=tuple(runs)), ROBOT)]
    assert [(one.level, one.column) for one in said] == [("warning", name)] * is_told
    assert all(f"steps of {step:g} m" in one.message for one in said)
