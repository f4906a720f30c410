"""A two-joint robot that reports torque and has a secondary encoder, and campaigns of it."""

from pathlib import Path

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Acting
from bench.hide.campaign import hide_campaign
from bench.predict.predict import predict
from bench.predict.prediction import PredictedRecording, Prediction
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests.report.handover.made import torque_robot
from tests.simulate.rotation_small import small_rotation


def campaign_of(compiled: CompiledRobot, seed: int, hidden: str = "", **values: float) -> Campaign:
    """Return sweeps with two payloads that are written down; at most one effect acts, all else is as nominal."""
    robot, effects = compiled.robot, catalogue()
    acting = [Acting(effects[hidden], WHOLE, effects[hidden].complete(values))] if hidden else []
    rng = np.random.default_rng(seed)
    return hide_campaign(robot, small_rotation(robot.folder), acting, rng, background=False, tails=None).campaign


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return torque_robot(tmp_path_factory.mktemp("predicted") / "small")


@pytest.fixture(scope="session")
def nominal(folder: Path) -> CompiledRobot:
    return compile_robot(load_robot(folder))


@pytest.fixture(scope="session")
def campaign(nominal: CompiledRobot) -> Campaign:
    return campaign_of(nominal, 1)


@pytest.fixture(scope="session")
def prediction(campaign: Campaign, nominal: CompiledRobot) -> Prediction:
    """Return what the nominal robot makes of the campaign, with nothing free."""
    return predict(campaign, nominal, nominal)


@pytest.fixture(scope="session")
def plain(prediction: Prediction) -> PredictedRecording:
    """Return what that leaves of its only recording."""
    (found,) = prediction.recordings
    return found
