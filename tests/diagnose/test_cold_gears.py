"""A gearbox that works in warm air and does not warm up is hardly one; sound days and halls have none."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from bench.diagnose.plausibility.cold_gears import cold_gears
from bench.hide.thermometers import CHANNELS, temperatures
from bench.hide.warm_up import Spell, WarmUp
from bench.record.campaign import Campaign, Run

ROWS, RUNS, APART_S = 40, 12, 450.0  # of a session of 90 minutes


def session(seed: int) -> Campaign:
    """Return a day of two drives with its thermometers, without anything else that is measured."""
    rng = np.random.default_rng(seed)
    conditions = WarmUp.draw(2, rng).over([Spell(APART_S, works=True)] * RUNS)
    time = np.arange(ROWS) / 10
    runs = []
    for i, one in enumerate(conditions):
        columns = {"time_s": time} | {f"q_motor_{j}_rad": np.sin(time) for j in (1, 2)}
        columns |= temperatures(one, ROWS, CHANNELS, rng)
        runs.append(Run(f"run{i}", "motion", APART_S * i, columns))
    return Campaign("mine", tuple(runs))


def exchanged(campaign: Campaign, one: str, other: str) -> Campaign:
    def swap(run: Run) -> Run:
        columns = run.columns | {one: run.columns[other], other: run.columns[one]}
        return replace(run, columns=columns)

    return replace(campaign, runs=tuple(map(swap, campaign.runs)))


@pytest.mark.parametrize("seed", range(30))
def test_sound_days_have_no_cold_gear(seed: int) -> None:
    assert list(cold_gears(session(seed))) == []


def test_temperatures_of_gear_and_air_that_are_exchanged_are_told() -> None:
    """They were believed. Where the air warmed up by itself as a gear would that only stands there, nobody can tell."""
    told = [
        list(cold_gears(exchanged(session(seed), "gear_temperature_1_k", "ambient_temperature_k")))
        for seed in range(30)
    ]
    assert sum(map(len, told)) >= 24
    assert all(finding.column == "gear_temperature_1_k" for findings in told for finding in findings)
    assert all(finding.level == "warning" for findings in told for finding in findings)


def test_a_cold_robot_in_a_hall_that_is_heated_is_sound() -> None:
    """A gear with a time constant of an hour, in air that gains 15 K in 90 minutes, or was 15 K warmer before."""
    time = APART_S * np.arange(RUNS)
    for air in (290 + 15 * time / time[-1], np.full(RUNS, 305.0)):
        gear = [290.0]
        for before, after in pairwise(air):
            gear.append(gear[-1] + ((before + after) / 2 - gear[-1]) * (1 - np.exp(-APART_S / 3600)))
        runs = [
            replace(
                run,
                columns=run.columns
                | {"ambient_temperature_k": np.full(ROWS, a), "gear_temperature_1_k": np.full(ROWS, np.round(g, 1))},
            )
            for run, a, g in zip(session(0).runs, air, gear, strict=True)
        ]
        assert [finding for finding in cold_gears(Campaign("mine", tuple(runs))) if "_1_" in finding.column] == []


def test_what_the_air_did_in_a_night_is_not_known() -> None:
    """Robot and hall cool down over night; in the morning the hall is heated before the robot works."""
    runs = []
    for run, hours, air, gear in zip(
        session(0).runs[:3], (0, 12, 12.2), (300, 300, 300), (300, 284, 284.5), strict=True
    ):
        columns = {"ambient_temperature_k": np.full(ROWS, air), "gear_temperature_1_k": np.full(ROWS, gear)}
        runs.append(replace(run, start_s=3600.0 * hours, columns=run.columns | columns))
    assert [finding for finding in cold_gears(Campaign("mine", tuple(runs))) if "_1_" in finding.column] == []
