"""Gear ratios from torque: of an arm that is as its file says, and of arms that err as much as they say."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.identify.angle_scale import AngleScale, angle_scale
from bench.record.look.values import evenly
from bench.robot.nominal_dynamics import NominalDynamics
from tests import scara, stranger
from tests.stranger_started import erring, started

DRIVES = 3
MOST = 8  # logs, of three ratios each
NINETY = 1.645  # exact: standard deviations to either side that hold 90 %
LEAST_HELD = {3: 6, MOST: 18}  # of intervals of 90 %: fewer come by chance less than once in 100 (binomial)
RIGHT = 0.02  # relative: a quarter of what masses leave open; friction is a sharper step than the model's, and noise
EVERY = np.ones(DRIVES, dtype=np.bool_)


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> NominalDynamics:
    """Return the stranger's arm as `bench new-robot` starts it."""
    return started(tmp_path_factory.mktemp("stranger"))


def scale_of(
    arm: NominalDynamics, motion: stranger.Motion, ratio: np.ndarray, sought: np.ndarray = EVERY
) -> AngleScale:
    """Estimate from angles and torques on the motors' side, on the slow clock that logs are looked at."""
    names = [f"{kind}{j}" for kind in "qy" for j in range(DRIVES)]
    columns = np.hstack([motion.position * ratio, motion.torque / ratio])
    clock, slow = evenly(motion.time, dict(zip(names, columns.T, strict=True)))
    values = np.stack([slow[name] for name in names], axis=1)[5:-5]
    return angle_scale(arm, clock[5:-5], values[:, :DRIVES], values[:, DRIVES:], sought)


@pytest.mark.parametrize("ratio", [(50.0, 121.0, 200.0), (-160.0, 101.0, -99.0)])
def test_ratios_of_an_arm_that_is_as_its_file_says(arm: NominalDynamics, ratio: tuple[float, ...]) -> None:
    motion = stranger.moved(np.random.default_rng(4), 20.0, stranger.as_filed(2.0))
    scale = scale_of(arm, motion, np.array(ratio))
    np.testing.assert_allclose(scale.factor[1:] * np.abs(ratio[1:]), 1, rtol=RIGHT)
    assert abs(scale.factor[0] * abs(ratio[0]) - 1) < NINETY * scale.sigma[0]  # of a yaw only Coriolis torques tell
    assert scale.unexplained < 0.01 < 0.1 < scale.unexplained_as_given


def test_what_is_not_sought_stays(arm: NominalDynamics) -> None:
    motion = stranger.moved(np.random.default_rng(4), 20.0)
    scale = scale_of(arm, motion, np.array([1.0, 1.0, 80.0]), np.array([False, False, True]))
    assert scale.factor[:2].tolist() == [1, 1]
    assert scale.sigma[:2].tolist() == [0, 0]
    assert scale.factor[2] == pytest.approx(1 / 80, rel=RIGHT)


def test_a_joint_that_stands_at_zero_tells_nothing(arm: NominalDynamics) -> None:
    motion = stranger.moved(np.random.default_rng(4), 20.0)
    still = replace(motion, position=motion.position * [0, 1, 1])
    assert np.isinf(scale_of(arm, still, np.full(DRIVES, 100.0)).sigma[0])


@pytest.mark.parametrize("logs", [3, pytest.param(MOST, marks=pytest.mark.study)])
def test_ratios_lie_within_what_is_said_of_them(arm: NominalDynamics, logs: int) -> None:
    """Payloads of 0 to 5 kg that nobody stated; masses, centres and rotors err by what the arm states of them."""
    scores = []
    for seed in range(logs):
        rng = np.random.default_rng(200 + seed)
        motion = stranger.moved(rng, 15.0, stranger.as_filed(rng.uniform(0, 5)))
        ratio = rng.uniform(50, 200, DRIVES)
        scale = scale_of(erring(arm, rng), motion, ratio)
        scores.append(np.log(scale.factor * ratio) / scale.sigma)
    assert int(np.sum(np.abs(scores) < NINETY)) >= LEAST_HELD[logs]
    assert np.std(scores) > 0.3  # nor are they wide for nothing


def test_ratios_beside_a_payload_that_hangs_beside_its_axis(tmp_path: Path) -> None:
    """The inertia of the payload went into the ratios: 5 of 18 intervals held them, and J4 was told to 24 % at best."""
    robot, hinges = started(tmp_path, scara.mjcf()), [0, 1, 3]
    scores, sigmas = [], []
    for seed in range(MOST):
        rng = np.random.default_rng(200 + seed)
        log = scara.moved(rng, scara.Load(rng.uniform(0.5, 2.0), tuple(0.04 * rng.normal(size=3))))
        ratio = np.array([1.0 if j == 2 else rng.uniform(50, 200) for j in range(scara.N)])
        names = [f"{kind}{j}" for kind in "qy" for j in range(scara.N)]
        columns = np.hstack([log.position * ratio, log.current])
        clock, slow = evenly(log.time, dict(zip(names, columns.T, strict=True)))
        values = np.stack([slow[name] for name in names], axis=1)[5:-5]
        sought = np.isin(np.arange(scara.N), hinges)
        scale = angle_scale(erring(robot, rng), clock[5:-5], values[:, : scara.N], values[:, scara.N :], sought)
        scores.append(np.log(scale.factor * ratio)[hinges] / scale.sigma[hinges])
        sigmas.append(scale.sigma[hinges])
    assert int(np.sum(np.abs(scores) < NINETY)) >= LEAST_HELD[MOST]
    assert np.std(scores) > 0.3
    assert np.max(sigmas) < 0.1
