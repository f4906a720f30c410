"""Factors of readings: friction at rest is no load, and an arm that is not as stated has no light factors."""

import numpy as np
import pinocchio as pin
import pytest

from bench.report.log_look.lines import UNTOLD
from bench.robot.nominal_dynamics import NominalDynamics
from tests import stranger
from tests.identify.test_drive_delay import scale_of
from tests.stranger_started import started

LOGS = 8  # three factors each
BIAS = 0.1  # of the logarithm: of 24 factors that are told to 20 %, the median scatters by 5 %
SIGMAS = 3.0  # standard deviations by which a factor may be off; 24 of them are within in 15 tests of 16
MOVE, REST = 1.0, 1.0  # [s]
RATE = 100.0  # [Hz]


@pytest.fixture(scope="module")
def guessed(tmp_path_factory: pytest.TempPathFactory) -> NominalDynamics:
    """Return the arm as a file with a placeholder for rotors has it."""
    return started(tmp_path_factory.mktemp("guessed"), stranger.mjcf(armature=5.0))


def from_point_to_point(rng: np.random.Generator, arm: stranger.Arm, moves: int) -> stranger.Motion:
    """Move an arm between poses at which it rests; there friction holds whatever part of the load it happens to."""
    data, steps = arm.links.createData(), round((MOVE + REST) * RATE)
    time = np.arange(moves * steps) / RATE
    poses = rng.uniform(-1.2, 1.2, (moves + 1, 3))
    u = np.clip(np.arange(steps) / RATE / MOVE, 0.0, 1.0)[:, None]
    inside = u < 1
    blends = (
        u**3 * (10 - 15 * u + 6 * u**2),
        30 * u**2 * (1 - u) ** 2 / MOVE,
        inside * (60 * u - 180 * u**2 + 120 * u**3) / MOVE**2,
    )
    ways = np.diff(poses, axis=0)
    position, velocity, acceleration = (
        np.concatenate([k * start + blend * way for start, way in zip(poses, ways, strict=False)])
        for k, blend in zip((1, 0, 0), blends, strict=True)
    )
    links = np.array([pin.rnea(arm.links, data, *s) for s in zip(position, velocity, acceleration, strict=True)])
    held = np.repeat(rng.uniform(-1, 1, (moves, 3)), steps, axis=0) * np.array(stranger.COULOMB)
    friction = np.where(np.tile(inside, (moves, 1)), arm.friction(velocity, links), held)
    torque = links + np.array(arm.rotor) * acceleration + friction + rng.normal(size=links.shape) * stranger.SIGMA
    return stranger.Motion(time, position, velocity, torque)


def test_what_friction_holds_at_rest_is_no_load(guessed: NominalDynamics) -> None:
    """Held friction was load: factors were off by 17 % in the mean, and 17 of 24 were not told to 30 %."""
    off, sigma = [], []
    for seed in range(LOGS):
        rng = np.random.default_rng(seed)
        motion = from_point_to_point(rng, stranger.unlike_its_file(rng), 15)
        scale = scale_of(guessed, motion, motion.torque)
        off.append(np.log(np.abs(scale.factor)))
        sigma.append(scale.sigma)
    assert np.max(sigma) < UNTOLD
    assert np.max(np.abs(off) / sigma) < SIGMAS


def test_an_arm_that_is_not_as_stated_has_no_light_factors(guessed: NominalDynamics) -> None:
    """The best fit is one of a light arm: half of all factors were too small by a fifth or more, some by ten."""
    off = []
    for seed in range(LOGS):
        rng = np.random.default_rng(seed)
        motion = stranger.moved(rng, 20.0, stranger.unlike_its_file(rng))
        off.append(np.log(np.abs(scale_of(guessed, motion, motion.torque).factor)))
    assert abs(np.median(off)) < BIAS
