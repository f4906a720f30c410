"""The delay of readings: a shift keeps noise as it is, and friction that turns late is no delay."""

import numpy as np
import pytest

from bench.identify.drive_model import shifted
from bench.identify.drive_scale import DriveScale, drive_scale
from bench.record.look.values import evenly
from bench.robot.nominal_dynamics import NominalDynamics
from tests import stranger
from tests.stranger_started import started

DRIVES = 3
LOGS = 4
SIGMAS = 3.0  # standard deviations by which the mean of them may be off
WIDEST = 3e-3  # [s], standard deviation of that mean, above which a test of it tells nothing
BRISTLES = 7e-3  # [s], by which friction turns late where 0.1 mrad bend first, at 3 rad/s^2


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> NominalDynamics:
    """Return the stranger's arm as `bench new-robot` starts it."""
    return started(tmp_path_factory.mktemp("stranger"))


def scale_of(arm: NominalDynamics, motion: stranger.Motion, torque: np.ndarray) -> DriveScale:
    names = [f"{kind}{j}" for kind in "qy" for j in range(DRIVES)]
    columns = np.hstack([motion.position, torque])
    clock, slow = evenly(motion.time, dict(zip(names, columns.T, strict=True)))
    values = np.stack([slow[name] for name in names], axis=1)[5:-5]
    return drive_scale(arm, clock[5:-5], values[:, :DRIVES], values[:, DRIVES:])


@pytest.mark.parametrize("delay", [0.004, 0.01, -0.03])
def test_a_shift_keeps_signal_and_noise(rng: np.random.Generator, delay: float) -> None:
    """Straight lines take half of white noise away at half a sample."""
    time = np.arange(1000) / 50
    noise = rng.normal(size=(len(time), 2))
    assert np.var(shifted(time, noise, delay)) == pytest.approx(np.var(noise), rel=0.02)
    waves = np.column_stack([np.sin(3 * time) + 2 * time, np.cos(20 * time)])
    later = np.column_stack([np.sin(3 * (time + delay)) + 2 * (time + delay), np.cos(20 * (time + delay))])
    np.testing.assert_allclose(shifted(time, waves, delay)[25:-25], later[25:-25], atol=1e-3)


def test_two_samples_are_shifted() -> None:
    np.testing.assert_allclose(shifted(np.array([0.0, 0.1]), np.array([[1.0], [2.0]]), 0.05), [[1.5], [2.5]])


@pytest.mark.parametrize("delay", [0.0, 0.01])
def test_friction_that_turns_late_is_no_delay(arm: NominalDynamics, delay: float) -> None:
    """7 ms more were told of such logs, each to a tenth of a millisecond."""
    found = []
    for seed in range(LOGS):
        motion = stranger.moved(np.random.default_rng(seed), 20.0, torque_delay=delay)
        when = motion.time - delay
        now, late = (
            np.stack([np.interp(at, motion.time, v) for v in motion.velocity.T], axis=1)
            for at in (when, when - BRISTLES)
        )
        bristles = np.array(stranger.COULOMB) * (np.tanh(late / 0.01) - np.tanh(now / 0.01))
        found.append(scale_of(arm, motion, motion.torque + bristles))
    sigma = np.sqrt(np.mean([scale.delay_sigma**2 for scale in found]) / LOGS)
    assert sigma < WIDEST
    assert abs(np.mean([scale.delay for scale in found]) - delay) < min(SIGMAS * sigma, 0.8 * BRISTLES)


@pytest.mark.parametrize("seed", [1, 4])
def test_a_drive_that_disagrees_is_in_the_error(arm: NominalDynamics, seed: int) -> None:
    """Of a stranger's arm that rang, all currents were said to lead by 4.3 +- 0.2 ms; they were 4.5 ms late."""
    right, misled = 0.004, -0.02  # [s]
    late, early = (stranger.moved(np.random.default_rng(seed), 20.0, torque_delay=delay) for delay in (right, misled))
    found = scale_of(arm, late, np.column_stack([late.torque[:, :2], early.torque[:, 2]]))
    alike = scale_of(arm, late, late.torque)
    assert abs(alike.delay - right) < SIGMAS * alike.delay_sigma
    assert abs(found.delay - right) < SIGMAS * found.delay_sigma
    assert found.delay_sigma > alike.delay_sigma
