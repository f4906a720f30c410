"""What the tests of the hand-over share."""

import pytest

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.report.handover.made import design_for, torque_robot
from tests.small_robot import write_small_robot


@pytest.fixture(scope="module", params=["current", "torque"])
def linear(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> LinearisedModel:
    folder = tmp_path_factory.mktemp("robots") / "small"
    (write_small_robot if request.param == "current" else torque_robot)(folder)
    return design_for(compile_robot(load_robot(folder)))
