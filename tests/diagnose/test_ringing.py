"""How long after a jerk, or after a run begins, an arm may still ring."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.linearise.other_noise import roughened, with_ringing
from bench.diagnose.replay.motion_segments import fading, kept_up, lowest_period, settling_periods, stretches_of
from bench.diagnose.replay.segment_input import SegmentInput
from bench.record.campaign import Array, Run
from bench.record.joined import joined
from tests.diagnose.noise_free import fitted_alone, linearised, noise_free
from tests.diagnose.sweeps import SWEEP, made, nominal

SAMPLE = 0.004  # [s]
SECONDS = 12.0
SPEED = 0.1  # [rad/s]


def piece_of(run: Run, speed: Array) -> tuple[SegmentInput, float]:
    """Return a motion of joint 2 at a speed, shape (rows,), and the period of the arm's lowest mode."""
    compiled = nominal()
    time = np.arange(len(speed)) * SAMPLE
    angle = -0.3 + np.cumsum(speed) * SAMPLE
    columns = {"time_s": time} | {f"q_motor_{i + 1}_rad": np.zeros(len(time)) for i in range(compiled.n_joints)}
    columns["q_motor_2_rad"] = angle
    (segment_input,) = stretches_of(replace(run, columns=columns), compiled, 0.1)
    at = np.zeros(compiled.n_joints)
    at[1] = angle.mean()
    return segment_input, lowest_period(compiled, at)


def test_it_may_ring_after_the_beginning_and_after_a_jerk_and_no_longer() -> None:
    run = next(run for run in made(SWEEP, seed=3).runs if run.kind == "motion")
    time = np.arange(0, SECONDS, SAMPLE)
    steady, period = piece_of(run, np.full(len(time), SPEED))
    jerk = SECONDS / 2
    jerked, _ = piece_of(run, np.where(time < jerk, SPEED, 0.6 * SPEED))
    for segment_input, starts in ((steady, [0.0]), (jerked, [0.0, jerk])):
        begins = np.array([time[rows[0]] for rows in segment_input.groups])
        ends = np.array([time[rows[-1]] for rows in segment_input.groups])
        surely = np.any(
            [(begins >= start + 0.3) & (ends < start + settling_periods() * period) for start in starts], axis=0
        )
        hardly = np.all(
            [(ends < start - 0.5) | (begins > start + settling_periods() * period + 0.5) for start in starts], axis=0
        )
        assert np.any(surely)
        assert np.any(hardly)
        assert np.all(segment_input.rings[surely])
        assert not np.any(segment_input.rings[hardly])


@pytest.mark.parametrize("period", [1e300, np.inf])
def test_an_arm_that_swings_for_ever_is_unresolved_everywhere(period: float) -> None:
    """A stranger's body of 1e300 kg: found by `python -m tests.poison`, as a traceback."""
    unresolved = np.zeros((7, 1))
    unresolved[1] = 1.0
    np.testing.assert_array_equal(kept_up(unresolved, 1, 0.01 * np.arange(7), period), 1.0)


def test_what_rings_fades_as_a_mode_does_until_it_is_struck_again() -> None:
    """Damped to 5 % of critical: to exp(-2 pi 0.05) of it in a period, then on from the largest that is left."""
    time, struck = 0.1 * np.arange(6), np.array([0.0, 1.0, 0.0, 0.9, 0.0, 0.0])[:, None]
    left = np.exp(-2 * np.pi * 0.05)
    np.testing.assert_allclose(fading(struck, time, 0.1)[1:, 0], [1, left, 0.9, 0.9 * left, 0.9 * left**2])


def test_what_rings_does_not_lean_the_floor() -> None:
    """Two days of a sound robot without noise: -1.3 mrad for 67 nats in bins as long as a period of its lowest mode."""
    days = joined({"may": noise_free("session-short", 904), "june": noise_free("session-short", 905)})
    fit = fitted_alone(linearised(days), days, "floor_tilt", "robot")
    print(f"floor_tilt: {1e3 * fit.values} mrad, +- {1e3 * fit.sigma} mrad with the noise of a campaign")
    assert np.all(np.abs(fit.values) < 2 * fit.sigma)


def test_what_a_better_model_explains_after_a_jerk_is_no_noise_any_more(rng: np.random.Generator) -> None:
    """What was rough about the nominal model, as a force that is late, hid what else acts for good."""
    linear = linearised(made(SWEEP, seed=3))
    rings = [segment.rings for segment in linear.segments]
    assert any(np.any(rows) and not np.all(rows) for rows in rings)
    sigma = np.concatenate([segment.sigma for segment in linear.segments])
    poor = 30 * np.nan_to_num(sigma) * rng.standard_normal(sigma.shape)
    noisy = roughened(linear, poor, rings)
    assert sum(np.sum(new.sigma > old.sigma) for new, old in zip(noisy.weighed, linear.weighed, strict=True)) > 0
    better = with_ringing(noisy, np.zeros_like(poor))
    for now, stated in zip(better.weighed, linear.segments, strict=True):
        np.testing.assert_array_equal(now.sigma[now.rings], stated.sigma[now.rings])
    assert with_ringing(better, poor) is better, "no reading is less sure for a model that misses more"
