"""A clock that is not in seconds shows as a factor that all inertias have in common."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.plausibility.channels import doubts_of
from bench.diagnose.plausibility.drive_looks import Factor, clock_of
from bench.diagnose.plausibility.speeds import fastest
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot
from tests.diagnose.drive_looks import looks, stating_rotors
from tests.diagnose.sweeps import SWEEPS, Change, changed, in_motion, made, scale

DRAWS = 3000
DECLARED = 0.01  # share of healthy clocks outside of an interval at 99 %
MOST = 0.015  # 2.7 standard errors of 3000 draws above it


def test_a_clock_is_the_root_of_what_all_inertias_have_in_common(robot: CompiledRobot) -> None:
    clock = clock_of(looks(np.full(6, 1.21)), robot, 0.999)
    assert clock
    assert clock.rate == pytest.approx(1.1)
    assert clock.low > 1
    one_inertia = clock_of(looks(np.array([1.21, 1, 1, 1, 1, 1])), robot, 0.999)
    assert one_inertia
    assert one_inertia.low < 1 < one_inertia.high
    assert clock_of(looks(np.array([1.21])), robot, 0.999) is None, "one joint may have another inertia"


def test_one_rotor_that_is_known_does_not_doubt_a_clock(robot: CompiledRobot) -> None:
    """It may be half as heavy again as stated; others agree with it only because nobody knows theirs."""
    motion = np.array([1.5, 1, 1, 1, 1, 1])
    alone = clock_of(looks(motion), stating_rotors(robot, 0.1, *[3.0] * 5), 0.999)
    assert alone
    assert alone.low < 1 < alone.high
    two = clock_of(looks(np.full(6, 1.5)), stating_rotors(robot, 0.1, 0.1, *[3.0] * 4), 0.999)
    assert two
    assert two.low > 1


def test_an_unstated_payload_leaves_the_clock_open(robot: CompiledRobot) -> None:
    figures = robot.robot.figures
    heavy = figures.model_copy(update={"uncertainty": figures.uncertainty.model_copy(update={"payload_kg": 300.0})})
    untold = [replace(look, gravity=Factor(np.nan, np.inf)) for look in looks(np.full(6, 1.5))]
    assert clock_of(untold, replace(robot, robot=replace(robot.robot, figures=heavy)), 0.999) is None
    assert clock_of(untold, robot, 0.999)


def test_healthy_clocks_are_doubted_as_rarely_as_declared(robot: CompiledRobot, rng: np.random.Generator) -> None:
    sigma = robot.robot.figures.uncertainty.rotor_inertia
    outside = 0
    for factors in np.exp(rng.normal(0, sigma, (DRAWS, 6))):
        clock = clock_of(looks(factors), robot, 1 - DECLARED)
        assert clock
        outside += not clock.low <= 1 <= clock.high
    assert outside <= MOST * DRAWS


def rows_for_seconds(columns: dict[str, np.ndarray]) -> None:
    columns["time_s"] = np.arange(len(columns["time_s"]), dtype=np.float64)


@pytest.mark.parametrize("change", [scale(60.0, "time_s"), scale(10.0, "time_s"), rows_for_seconds])
def test_a_clock_by_which_no_inertia_shows_is_doubted(
    short_session: Campaign, robot: CompiledRobot, change: Change
) -> None:
    (doubt,) = doubts_of(changed(short_session, in_motion(change)), robot)
    assert doubt.column == "time_s"
    assert "seconds for each second" in doubt.message


def test_a_clock_that_is_20_percent_fast_is_doubted(short_session: Campaign, robot: CompiledRobot) -> None:
    (doubt,) = doubts_of(changed(short_session, in_motion(scale(1.2, "time_s"))), robot)
    assert (doubt.level, doubt.column) == ("doubt", "time_s")
    assert "seconds for each second" in doubt.message


@pytest.mark.parametrize("speed", [2.0, 8.0])
def test_a_recording_that_was_slow_has_a_right_clock(robot: CompiledRobot, speed: float) -> None:
    """It shows no inertia either, at 2 to 8 % of what its drives can."""
    sweeps = SWEEPS.model_copy(update={"speeds_deg_per_s": (speed,), "end_deg": -20 + 6 * speed})
    assert doubts_of(made(sweeps, seed=1), robot) == ()


def test_the_fastest_joint_need_not_be_the_first(short_session: Campaign, robot: CompiledRobot) -> None:
    """Joint 1 stands: a clock was divided by next to nothing, and the check died of a window of 1e20 samples."""
    of_joint_3 = replace(short_session, runs=tuple(run for run in short_session.runs if run.name.startswith("joint3")))
    assert of_joint_3.runs
    assert fastest(of_joint_3, robot) > 0.1
