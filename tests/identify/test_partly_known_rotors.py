"""An arm whose file leaves one rotor out: that drive's is free, the others count as well known as they are."""

from dataclasses import replace

import numpy as np
import pytest

from bench.identify.angle_scale import _within_uncertainty
from bench.identify.arm import Arm
from bench.identify.drive_model import LinksAlong, Motion, carrying, model_columns, solved
from bench.identify.drive_scale import DriveScale
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.prior import prior_of
from bench.robot.nominal_dynamics import NominalDynamics
from bench.robot.starter.defaults import ROTOR_GUESSED
from tests import stranger
from tests.identify.test_drive_delay import scale_of
from tests.rigid_links import link_torque
from tests.stranger_started import MISSING, but_one_rotor, erring, started

DRIVES = 3
KNOWN = [0, 2]
LOGS = 8  # three factors each
NINETY = 1.645  # exact: standard deviations to either side that hold 90 %
LEAST_HELD = 18  # of 24 intervals of 90 %: fewer come by chance once in 100 (binomial)
ROUNDING = 1e-9  # relative


@pytest.fixture(scope="module")
def stated(tmp_path_factory: pytest.TempPathFactory) -> NominalDynamics:
    return started(tmp_path_factory.mktemp("stated"))


@pytest.fixture(scope="module")
def partly(tmp_path_factory: pytest.TempPathFactory) -> NominalDynamics:
    return started(tmp_path_factory.mktemp("partly"), but_one_rotor())


@pytest.fixture(scope="module")
def guessed(tmp_path_factory: pytest.TempPathFactory) -> NominalDynamics:
    return started(tmp_path_factory.mktemp("guessed"), stranger.mjcf(armature=5.0))


@pytest.fixture(scope="module")
def motion() -> stranger.Motion:
    return stranger.moved(np.random.default_rng(4), 15.0, stranger.as_filed(2.0))


def test_the_rotor_that_is_missing_alone_has_a_coefficient_of_its_own(
    stated: NominalDynamics, partly: NominalDynamics, guessed: NominalDynamics, motion: stranger.Motion
) -> None:
    every = 20  # effort: samples between those that count
    along = Motion.along(motion.time[::every], motion.position[::every])
    reading = motion.torque[::every]
    columns = {id(arm): model_columns(arm, LinksAlong.of(arm, along)) for arm in (stated, partly, guessed)}
    links = link_torque(partly.bodies, along)
    torque, acceleration = columns[id(partly)][:, :, 0].T, columns[id(partly)][:, :, 4].T
    of_rotors = partly.rotor_inertia * along.acceleration
    np.testing.assert_allclose(torque[:, KNOWN], (links + of_rotors)[:, KNOWN])
    np.testing.assert_allclose(torque[:, MISSING], links[:, MISSING])
    np.testing.assert_allclose(acceleration[:, MISSING], along.acceleration[:, MISSING])
    assert not np.any(acceleration[:, KNOWN])
    # each drive as on an arm of which all rotors are as well known as its own
    found = {id(arm): solved(carrying(columns[id(arm)], 2.0), reading)[:, 0] for arm in (stated, partly, guessed)}
    np.testing.assert_allclose(found[id(partly)][KNOWN], found[id(stated)][KNOWN], rtol=ROUNDING)
    np.testing.assert_allclose(found[id(partly)][MISSING], found[id(guessed)][MISSING], rtol=ROUNDING)


def test_a_rotor_that_is_known_counts_in_what_is_said_of_its_factor(
    partly: NominalDynamics, motion: stranger.Motion
) -> None:
    """Where masses and centres are exact, what is left is the log's scatter and the rotors that are known."""
    exact = {"mass": 0.0, "centre_of_mass_m": 0.0}
    sigmas = []
    for rotor_inertia in ((0.0, 3.0, 0.0), (0.1, 3.0, 0.5), (0.1, 30.0, 0.5)):
        unsure = partly.uncertainty.model_copy(update=exact | {"rotor_inertia": rotor_inertia})
        sigmas.append(scale_of(replace(partly, uncertainty=unsure), motion, motion.torque).sigma)
    assert np.all(sigmas[1][KNOWN] > 1.2 * sigmas[0][KNOWN])
    # it tells less of the payload too, so of all factors
    assert np.all(sigmas[1][MISSING] > sigmas[0][MISSING])
    np.testing.assert_allclose(sigmas[2], sigmas[1], rtol=ROUNDING)


def test_factors_lie_within_what_is_said_of_them(partly: NominalDynamics) -> None:
    """Rotors of 1.6 kg m^2 that are guessed to 5, others that err by the tenth that is stated of them."""
    scales: list[DriveScale] = []
    for seed in range(LOGS):
        rng = np.random.default_rng(100 + seed)
        motion = stranger.moved(rng, 15.0, stranger.as_filed(rng.uniform(0, 5)))
        scales.append(scale_of(erring(partly, rng), motion, motion.torque / np.array(stranger.CONSTANT)))
    scores = np.array([(scale.factor / np.array(stranger.CONSTANT) - 1) / scale.sigma for scale in scales])
    assert int(np.sum(np.abs(scores) < NINETY)) >= LEAST_HELD
    assert np.std(scores) > 0.4  # nor are they wide for nothing


def test_angles_are_as_sure_as_the_rotors_that_are_known(partly: NominalDynamics) -> None:
    others = [arm for arm in _within_uncertainty(partly) if arm.bodies is partly.bodies]
    shares = np.array([arm.rotor_inertia / partly.rotor_inertia - 1 for arm in others])
    np.testing.assert_allclose(shares, 0.1 * np.eye(DRIVES)[KNOWN], atol=ROUNDING)


def test_the_first_pass_knows_each_drive_as_it_is_stated(partly: NominalDynamics) -> None:
    unsure = partly.uncertainty.model_copy(update={"friction": (0.1, 0.2, 0.3), "stiffness": (3.0, 0.03, 1.0)})
    arm = replace(partly, uncertainty=unsure, coulomb=np.array([9.0, 12.0, 3.0]), viscous=np.array([4.0, 6.0, 1.5]))
    layout, one = Layout(DRIVES, has_payload=False, has_gas=False), np.ones(DRIVES)
    prior = prior_of(layout, arm, Arm(arm.bodies), one, one)
    factor = prior.factor(prior.usual())
    sigma = np.sqrt(np.diag(factor @ factor.T))
    rotor = np.array([0.1, 0.1, 0.1])
    rotor[MISSING] = ROTOR_GUESSED
    for column, expected in (
        ("rotor", rotor * arm.rotor_inertia),
        ("coulomb", [0.9, 2.4, 0.9]),
        ("viscous", [0.4, 1.2, 0.45]),
    ):
        np.testing.assert_allclose(sigma[layout.of_drives(column)], expected)
    np.testing.assert_allclose(sigma[layout.softness], [3.0, 0.03, 1.0])
