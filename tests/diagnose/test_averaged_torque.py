"""Torques of drives are averaged with the weights with which accelerations are."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import solve_banded

from bench.diagnose.replay.motion_segments import lowest_period
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.segment_input import centre_weights
from bench.diagnose.replay.segments import Segment, segments_of
from bench.diagnose.replay.smooth_derivative import averaging_kernel, smooth_derivative
from bench.record.campaign import Array, Campaign
from tests.diagnose.sweeps import SWEEP, made, nominal

SAMPLE = 0.004  # [s]
INERTIA = 3.0  # [A s^2/rad], of a current that nothing but acceleration needs
CURRENT, DRIVE = "current_2_a", 1


def segment_of(speed: Array, current: Array, lost: bool = False) -> Segment:
    """Return the segment of a motion of joint 2 at a speed [rad/s] with a current [A], shape (rows,) each."""
    run = next(run for run in made(SWEEP, seed=3).runs if run.kind == "motion")
    time, compiled = np.arange(len(speed)) * SAMPLE, nominal()
    columns = {"time_s": time} | {f"q_motor_{i + 1}_rad": np.zeros(len(time)) for i in range(compiled.n_joints)}
    columns |= {"q_motor_2_rad": -0.3 + np.cumsum(speed) * SAMPLE, CURRENT: current}
    rows = np.delete(np.arange(len(time)), [401, 402]) if lost else np.arange(len(time))
    campaign = Campaign("hh150", (replace(run, columns={key: values[rows] for key, values in columns.items()}),))
    (segment,) = segments_of(campaign, compiled, quantities_of(campaign.runs, compiled))
    return segment


def ramps(seconds: float = 16.0) -> tuple[Array, Array]:
    """Return a speed with sudden accelerations, and the acceleration, shape (rows,) each."""
    time = np.arange(0, seconds, SAMPLE)
    acceleration = np.where((time % 4.0) < 0.25, 0.6, np.where(((time - 2.0) % 4.0) < 0.25, -0.6, 0.0))
    # second differences of the angles are averages over two samples: those whose acceleration at the sample is this
    between = np.outer([-1, 14, -1], np.ones(len(time))) / 12
    return 0.1 + np.cumsum(solve_banded((1, 1), between, acceleration)) * SAMPLE, acceleration


@pytest.mark.parametrize("window", [5, 15, 61])
def test_kernel_is_what_a_second_derivative_averages_with(window: int) -> None:
    values = np.cumsum(np.random.default_rng(1).standard_normal((200, 1)), axis=0)
    kernel, half = averaging_kernel(window), window // 2
    accelerations = np.convolve(values[:, 0], np.array([-1, 16, -30, 16, -1]) / 12, mode="valid")
    averaged = np.convolve(accelerations, kernel, mode="valid")
    found = smooth_derivative(values, window, 2, 1.0)[half + 1 : 199 - half, 0]
    np.testing.assert_allclose(averaged, found, atol=1e-9)
    assert kernel.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(kernel, kernel[::-1], atol=1e-12)


def test_sudden_accelerations_tell_inertia_exactly() -> None:
    """What goes with acceleration sample by sample goes with it bin by bin; averaged otherwise it is off by a tenth."""
    speed, acceleration = ramps()
    segment = segment_of(speed, INERTIA * np.roll(acceleration, -1))
    own = segment.motion.acceleration[segment.motion.read][:, DRIVE]
    observed = segment.observed[:, 0]
    assert segment.path
    inside = np.isfinite(observed)
    inside[:2] = inside[-2:] = False  # at the ends of a run derivatives have other weights
    assert np.ptp(observed[inside]) > 1.5 * INERTIA * 0.6
    np.testing.assert_allclose(observed[inside], INERTIA * own[inside], atol=1e-9)
    plain = np.array([(INERTIA * np.roll(acceleration, -1))[group].mean() for group in segment.path.groups])
    assert np.abs(plain - INERTIA * own)[inside].max() > 0.1


def test_rotors_are_not_scatter_while_they_accelerate() -> None:
    speed, acceleration = ramps()
    segment = segment_of(speed, np.roll(acceleration, -1))
    assert segment.drive_error is not None
    assert segment.path
    averaged = slice(2, -2)
    links, rotors = segment.drive_error[:, averaged, DRIVE]
    worst = segment.acceleration_error[averaged, DRIVE]
    assert np.max(segment.acceleration_error[2:-2, DRIVE]) == np.max(worst)
    assert np.max(worst) > 0.05  # of 0.6 rad/s^2, beside the jerks
    assert np.max(rotors) < 0.01 * np.max(worst)
    assert np.all(rotors <= links)
    assert np.all(links <= np.max(worst))
    assert np.all(links[worst > 0.9 * np.max(worst)] > 0.4 * np.max(worst))  # a period lets 0.46 of a jerk through
    quiet = np.flatnonzero(worst < 1e-6)
    assert len(quiet) > 1
    assert np.all(links[quiet] > rotors[quiet])  # they still ring


def test_without_even_samples_nothing_is_averaged_alike() -> None:
    speed, acceleration = ramps()
    segment = segment_of(speed, np.roll(acceleration, -1), lost=True)
    assert segment.path
    assert len(segment.path.kernel) == 1
    assert segment.drive_error is not None
    np.testing.assert_allclose(segment.drive_error[1, 2:-2], segment.acceleration_error[2:-2])


def test_coarse_samples_are_not_averaged_beyond_a_bin() -> None:
    """Else a fine ripple would be blurred: five samples of 160 ms are two bins and more."""
    campaign, compiled = made(SWEEP.model_copy(update={"sample_period_s": 0.16}), seed=3), nominal()
    for segment in segments_of(campaign, compiled, quantities_of(campaign.runs, compiled)):
        assert segment.path
        assert len(segment.path.kernel) == 1
        for group, (rows, weights) in zip(segment.path.groups, segment.path.of_torque, strict=True):
            np.testing.assert_array_equal(rows, group)
            np.testing.assert_array_equal(weights, centre_weights(len(group)))


def test_a_turn_is_followed_though_nothing_is_read_there() -> None:
    """Else friction would be taken for that of the way out where the arm has not yet come back as far as it was."""
    time = np.arange(0, 8.0, SAMPLE)
    speed = 0.1 * np.clip((4.0 - time) / 0.3, -1, 1)
    segment = segment_of(speed, np.sign(speed))
    q, read = segment.motion.q[:, DRIVE], segment.motion.read
    turn = int(np.argmax(q))
    assert not read[turn]
    assert np.count_nonzero(read) == len(segment)
    after = np.flatnonzero(read & (np.arange(len(read)) > turn))[0]
    assert q[after] < q[turn]
    assert np.all(np.isfinite(segment.observed[after - np.count_nonzero(~read[:after]) + 1 :, 0]))


def test_a_bin_beside_a_turn_is_not_read() -> None:
    """Averages reach into neighbours: no reading mixes friction of both directions."""
    time = np.arange(0, 8.0, SAMPLE)
    speed = np.where(time < 4.0, 0.1, -0.1)
    segment = segment_of(speed, np.sign(speed))
    values = segment.observed[np.isfinite(segment.observed[:, 0]), 0]
    np.testing.assert_allclose(np.abs(values), 1.0, atol=1e-9)
    assert {-1.0, 1.0} == set(np.sign(values))


def test_viscous_friction_is_that_of_the_average_speed() -> None:
    """Coarse samples, averaged over 60 ms: the speed in the middle of a bin made a lead of half a millisecond of it."""
    drag, time = 5.0, np.arange(0, 8.0, 0.02)
    turn = 2 * np.pi * 1.0
    run = next(run for run in made(SWEEP, seed=3).runs if run.kind == "motion")
    speed = 0.5 + 0.3 * np.sin(turn * time)
    columns = {"time_s": time} | {f"q_motor_{i + 1}_rad": np.zeros(len(time)) for i in range(nominal().n_joints)}
    columns |= {"q_motor_2_rad": 0.5 * time - 0.3 / turn * np.cos(turn * time), CURRENT: drag * speed}
    campaign = Campaign("hh150", (replace(run, columns=columns),))
    (segment,) = segments_of(campaign, nominal(), quantities_of(campaign.runs, nominal()))
    assert segment.path
    assert len(segment.path.kernel) > 1
    left = segment.observed[:, 0] - drag * segment.motion.velocity[segment.motion.read][:, DRIVE]
    middle = np.array([speed[group].mean() for group in segment.path.groups])
    assert np.nanmax(np.abs(left[2:-2])) < 2e-3 * drag * np.ptp(middle)


def test_what_links_do_not_follow_is_averaged_away_and_what_they_follow_is_kept() -> None:
    """Half a period of the lowest mode let 0.83 of it through, so motors that vibrate passed for inertia."""
    segment = segment_of(np.full(2000, 0.1), np.zeros(2000))
    assert segment.path
    rows, weights = segment.path.of_torque[len(segment.path.of_torque) // 2]
    time, mode = segment.path.time[rows], 1 / lowest_period(nominal(), segment.path.angles.mean(axis=0))

    def passes(frequency: float) -> float:
        return float(abs(weights @ np.exp(2j * np.pi * frequency * time)))

    assert passes(mode) < 0.5
    assert passes(1.5 * mode) < 0.15
    assert passes(0.1 * mode) > 0.99
