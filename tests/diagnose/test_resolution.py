"""Motions are differentiated over as long as their angles need, and no longer."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.resolution import angle_noise, finest_window, missed_by_average, step_of
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.smooth_derivative import averaging_kernel, noise_gain, smooth_derivative
from bench.robot.compiled import compile_robot
from bench.robot.instruments import CurrentSensor
from tests.diagnose.sweeps import SWEEP, made, nominal

STEP, SHORTEST, LONGEST = 0.008, 0.04, 1.0
TIME = np.arange(3000) * STEP
MOTION = np.stack([np.sin(2 * np.pi * 0.5 * TIME), 0.3 * np.cos(2 * np.pi * 1.1 * TIME)], axis=1)
INERTIA = np.array([[30.0, 4.0], [4.0, 6.0]])


def test_noise_of_angles_is_read_beside_a_motion(rng: np.random.Generator) -> None:
    sigma = np.array([3e-5, 1e-4])
    np.testing.assert_allclose(angle_noise(MOTION + sigma * rng.normal(size=MOTION.shape)), sigma, rtol=0.1)
    step = 2e-4  # as logs with four digits have it
    np.testing.assert_allclose(angle_noise(np.round(MOTION / step) * step), step / np.sqrt(12), rtol=0.1)
    assert np.all(angle_noise(MOTION) < 1e-9)


def test_steps_of_an_encoder_are_noise_also_where_a_joint_goes_on_by_whole_ones() -> None:
    """A stranger's slow runs at 0.02 m/s, 16 steps of 5 um a sample: delays of 7 ms were found that smooth the ramps.

    Three quarters of the time at such a speed, and a log in degrees with four digits beside it.
    """
    step, rate = 5e-6, 0.004
    speed = np.interp(np.arange(3000), [0, 100, 1300, 1500, 2700, 3000], [0, 0.02, 0.02, -0.05, -0.05, 0])
    way = np.cumsum(speed) * rate
    turn = np.deg2rad(np.round(np.rad2deg(way), 4))
    found = angle_noise(np.stack([np.round(way / step) * step, turn], axis=1))
    np.testing.assert_allclose(found, np.array([step, np.deg2rad(1e-4)]) / np.sqrt(12), rtol=0.1)
    assert np.all(angle_noise(np.stack([way, 1e3 + way], axis=1)) < 1e-9)


def test_an_encoder_that_ticks_is_read_in_steps() -> None:
    """One of 10 mrad has few different ways from sample to sample: rows were lost, or nothing was said of it."""
    way = 0.4 * np.sin(np.linspace(0, 9, 3000))
    for step in (1e-3, 1e-2, 3e-2):
        assert step_of(np.round(way / step) * step) == pytest.approx(step)
    even = np.concatenate([np.zeros(50), np.arange(100), np.full(50, 99), np.arange(99, 0, -1)])  # at one speed
    assert step_of(np.tile(even, 9) * 1e-3) == 0


def test_jumps_and_a_joint_that_stands_are_no_noise(rng: np.random.Generator) -> None:
    angles = MOTION + 1e-5 * rng.normal(size=MOTION.shape)
    angles[1000:, 0] += 0.5
    angles[:2000, 1] = angles[2000, 1]
    np.testing.assert_allclose(angle_noise(angles), 1e-5, rtol=0.3)


# at 2.5e-7 rad, five samples of 8 ms add just that quarter: the least window serves for what is better
@pytest.mark.parametrize("sigma", [2e-7, 1.5e-5, 1.5e-4])
def test_angles_add_no_more_to_torques_than_a_quarter_of_their_noise(sigma: float, rng: np.random.Generator) -> None:
    torque_noise = np.array([0.5, 0.2])
    window = finest_window(np.full(2, sigma), INERTIA, torque_noise, STEP, SHORTEST, LONGEST)

    def felt(seconds: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        samples = 2 * round(seconds / STEP / 2) + 1
        noise = sigma * rng.normal(size=(20_000, 2))
        acceleration = smooth_derivative(noise, samples, 2, STEP)[samples:-samples]
        own = np.linalg.norm(averaging_kernel(samples)) * torque_noise
        return np.asarray((acceleration @ INERTIA).std(axis=0) / (0.25 * own))

    assert np.all(felt(window) < 1.05)
    assert window == SHORTEST or np.any(felt(window / 1.5) > 1)
    assert (window == SHORTEST) == (sigma < 1e-5)


def test_drives_that_were_not_read_ask_for_nothing() -> None:
    unread = np.array([np.nan, np.nan])
    assert finest_window(np.full(2, 1e-3), INERTIA, unread, STEP, SHORTEST, LONGEST) == SHORTEST
    assert finest_window(np.full(2, 1.0), INERTIA, np.ones(2), STEP, SHORTEST, 0.3) == 0.3


def test_of_a_sensor_that_nobody_stated_the_samples_say_what_it_scatters() -> None:
    """The default of 0.02 A hid four fifths of what an arm showed whose current was read to 0.006."""
    robot, campaign = nominal(), made(SWEEP, seed=3)
    instruments = robot.robot.figures.instruments.model_copy(update={"current": CurrentSensor.model_validate({})})
    figures = robot.robot.figures.model_copy(update={"instruments": instruments})
    unsaid = compile_robot(replace(robot.robot, figures=figures))
    columns = [
        {name: values / 5 if name == "current_2_a" else values for name, values in run.columns.items()}
        for run in campaign.runs
    ]
    quiet = replace(
        campaign, runs=tuple(replace(run, columns=c) for run, c in zip(campaign.runs, columns, strict=True))
    )
    current = (Quantity("current_2_a", "current", "", 1),)
    stated, read = (
        np.nanmedian(np.concatenate([one.sigma for one in segments_of(quiet, one_robot, current) if not one.is_static]))
        for one_robot in (robot, unsaid)
    )
    assert read < 0.5 * stated


def test_gravity_in_the_middle_of_a_window_misses_its_average() -> None:
    """By its stiffness times half the variance of the weights times the acceleration, to second order."""
    stiffness, window = np.array([[200.0, 30.0], [30.0, 20.0]]), 15
    kernel = averaging_kernel(window)
    variance = np.sum(kernel * (STEP * (np.arange(len(kernel)) - len(kernel) // 2)) ** 2)
    acceleration = -MOTION * (2 * np.pi * np.array([0.5, 1.1])) ** 2
    expected = np.sqrt(np.mean((variance / 2 * acceleration @ stiffness.T) ** 2, axis=0))
    np.testing.assert_allclose(missed_by_average(MOTION, stiffness, window), expected, rtol=0.02)


def test_coarse_encoders_do_not_make_windows_so_long_that_gravity_is_missed() -> None:
    """Steps of 0.3 mrad made windows of 0.65 s, in which gravity was missed by five times the noise.

    It acted as inertia, and on an arm of 3 kg a torque that is read 17 ms late was named at more than 99.9 %.
    """
    given = np.full(2, 3e-4), INERTIA, np.array([0.5, 0.2]), STEP, SHORTEST, LONGEST
    stiffness = np.diag([200.0, 20.0])

    def worst(seconds: float) -> float:
        samples = 2 * round(seconds / STEP / 2) + 1
        own = given[2] * np.linalg.norm(averaging_kernel(samples))
        felt = INERTIA**2 @ (given[0] * noise_gain(samples, 2) / STEP**2) ** 2
        return float(np.max(np.sqrt(felt + missed_by_average(MOTION, stiffness, samples) ** 2) / own))

    window = finest_window(*given, lambda samples: missed_by_average(MOTION, stiffness, samples))
    assert SHORTEST < window < 0.7 * finest_window(*given)
    assert worst(window) < min(worst(0.7 * window), worst(1.5 * window))
