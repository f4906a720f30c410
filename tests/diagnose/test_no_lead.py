"""A replay of a sound robot, read without noise, finds its torques neither early nor late."""

import pytest

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.record.campaign import Campaign
from tests.diagnose.noise_free import fitted_alone, linearised, noise_free


@pytest.fixture(scope="module")
def ideal() -> tuple[LinearisedModel, Campaign]:
    """Return a lab's day with samples of 20 ms."""
    campaign = noise_free("session-study")
    return linearised(campaign), campaign


@pytest.mark.parametrize(
    ("name", "place", "most"), [("drive_delay", "robot", 0.1e-3), ("channel_delay", "current_5_a", 0.25e-3)]
)
def test_torques_are_on_time(ideal: tuple[LinearisedModel, Campaign], name: str, place: str, most: float) -> None:
    """It was 0.2 ms of all drives and 0.7 ms of joint 5: friction was that of the speed in the middle of a bin."""
    fit = fitted_alone(*ideal, name, place)
    print(f"{name} {place}: {1e3 * fit.values[0]:.3f} ms, +- {1e3 * fit.sigma[0]:.2f} ms with the noise of a campaign")
    assert abs(fit.values[0]) < most
