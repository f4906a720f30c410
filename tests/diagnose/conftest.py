"""What tests of a diagnosis share."""

import pytest

from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot
from bench.scenario.files import read_as
from bench.scenario.session import SessionScenario
from tests.diagnose.sweeps import made, nominal


@pytest.fixture(scope="module")
def robot() -> CompiledRobot:
    """Return the HH-150 as it is stated."""
    return nominal()


@pytest.fixture(scope="session")
def short_session() -> Campaign:
    """Return a healthy day with the HH-150, whose tests change copies of it."""
    return made(read_as(SessionScenario, "session-short"), seed=3)
