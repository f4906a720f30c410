"""What the tests of the report share."""

from pathlib import Path

import pytest

from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.robot.nominal_dynamics import NominalDynamics
from bench.simulate.session import Film
from tests.report.films import made_film
from tests.stranger_started import started


@pytest.fixture(scope="session")
def compiled(small_robot: Path) -> CompiledRobot:
    """Compile the two-joint robot."""
    return compile_robot(load_robot(small_robot))


@pytest.fixture(scope="session")
def film(compiled: CompiledRobot) -> Film:
    """Film it with perfect instruments."""
    return made_film(compiled)


@pytest.fixture(scope="session")
def arm(tmp_path_factory: pytest.TempPathFactory) -> NominalDynamics:
    """Return the stranger's arm as `bench new-robot` starts it."""
    return started(tmp_path_factory.mktemp("stranger"))
