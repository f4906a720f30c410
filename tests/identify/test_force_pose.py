"""The full force method: pose deflection from reflectors, Eq. (23), and what noise in its regressor does."""

from dataclasses import replace

import numpy as np
import pytest

from bench.errors import ConvergenceError, InputError
from bench.identify.arm import Arm
from bench.identify.force_pose import build_force_pose, identify_force_pose, solve_force_pose
from bench.identify.options import Options
from bench.identify.rigid_motion import pose_deflection
from tests.identify.hh150 import COUNTERBALANCE, STIFFNESS, hh150
from tests.identify.readings import bare_readings
from tests.identify.static_world import NOISE, World, measure
from tests.identify.test_methods import ladders

REFLECTORS = ("reflector_1", "reflector_2", "reflector_3")
ALL = np.ones(6, dtype=bool)
SECOND_ORDER = 0.02  # of a torque: J_m is linear, and its inverse magnifies near a stretched wrist
SEEDS = 12
POOR, HOPELESS = 4e-4, 1e-3  # [m], noise of a tracker with which Eq. (25) begins near no stiffness at all


@pytest.fixture(scope="module")
def arm():
    return Arm(hh150())


def world_readings(rng, noisy):
    return measure(World(np.zeros(6), np.zeros(6)), ladders(), rng, noisy=noisy, reflectors=REFLECTORS)


def test_pose_deflection_is_the_motion_of_the_reflectors(rng):
    points = rng.normal(0, 0.3, (3, 3))
    shift, turn = np.array([1e-3, -2e-3, 5e-4]), np.array([3e-4, 2e-4, -4e-4])
    moved = points + shift + np.cross(turn, points - points[0])
    readings = bare_readings(2, 6, reflectors=np.stack([points, moved]), reflector_names=REFLECTORS)
    found = pose_deflection(readings)
    np.testing.assert_allclose(found.change[1], np.concatenate([shift, turn]), atol=1e-12)


def test_its_covariance_is_that_of_many_readings(rng):
    """The first reflector stays; the others carry placement error as well."""
    points, draws = rng.normal(0, 0.3, (3, 3)), 5000
    readings = bare_readings(2, 6, reflectors=np.stack([points, points]), reflector_names=REFLECTORS)
    sigma = np.array([0.0, 1.0, 1.0]) * readings.systematic.placement
    sigma = np.hypot(sigma, readings.sigma_reflector / np.sqrt(10))[:, None]
    single = pose_deflection(readings)
    scattered = np.tile(points, (draws, 1, 1)) + sigma * rng.normal(size=(draws, 3, 3))
    many = bare_readings(draws + 1, 6, reflectors=np.concatenate([points[None], scattered]), reflector_names=REFLECTORS)
    changes = pose_deflection(many).change[1:]
    ratio = np.diag(np.cov(changes.T)) / np.diag(single.covariance[1])
    np.testing.assert_allclose(ratio, 1, atol=0.1)  # five sigma of 5000 draws


def test_reflectors_in_line_are_refused(rng):
    line = np.array([[0.0, 0, 0], [1, 1, 1], [2, 2, 2]])
    with pytest.raises(InputError, match="one line"):
        pose_deflection(bare_readings(2, 6, reflectors=np.stack([line, line]), reflector_names=REFLECTORS))


def test_equation_23_holds_for_the_true_stiffness(arm, rng):
    """H K = E of Eqs. (20) and (24), noise free, compared as joint torques; what is left is of second order."""
    problem = build_force_pose(arm, COUNTERBALANCE, world_readings(rng, noisy=False), Options(), 1 / STIFFNESS)
    missing = np.linalg.solve(problem.to_wrench, (problem.H @ STIFFNESS - problem.E)[..., None])[..., 0]
    assert np.all(np.abs(missing).max(axis=0) < SECOND_ORDER * np.abs(problem.load).max(axis=0))
    found = solve_force_pose(problem, ALL, STIFFNESS).parameters[:6]
    np.testing.assert_allclose(found, STIFFNESS, rtol=0.005)


def test_noise_in_the_regressor_biases_equation_25_but_not_the_method(arm):
    plain, method, sigma = [], [], []
    for seed in range(SEEDS):
        readings = world_readings(np.random.default_rng(seed), noisy=True)
        problem = build_force_pose(arm, COUNTERBALANCE, readings, Options(), np.zeros(6))
        plain.append(solve_force_pose(problem, ALL, None).parameters[:6] / STIFFNESS - 1)
        estimate = identify_force_pose(arm, COUNTERBALANCE, readings, Options())
        method.append(estimate.compliance * STIFFNESS - 1)
        sigma.append(np.sqrt(np.diag(estimate.covariance)) * STIFFNESS)
    assert np.median(plain, axis=0).min() < -0.1, "Eq. (25) calls joints too soft"
    assert np.all(np.abs(np.mean(method, axis=0)) < 4 * np.mean(sigma, axis=0) / np.sqrt(SEEDS))


@pytest.mark.parametrize("seed", range(5))
def test_it_goes_on_until_the_stiffness_stays(arm, seed, monkeypatch):
    """Four passes from Eq. (25) ended on the way: a joint 29 % too stiff, others called not observable."""
    monkeypatch.setitem(NOISE, "tracker", POOR)
    estimate = identify_force_pose(
        arm, COUNTERBALANCE, world_readings(np.random.default_rng(seed), noisy=True), Options()
    )
    assert estimate.observable.all()
    sigma = np.sqrt(np.diag(estimate.covariance)) * STIFFNESS
    assert np.all(np.abs(estimate.compliance * STIFFNESS - 1) < 4 * sigma)
    assert np.all(sigma < 0.1)


def test_what_does_not_settle_is_no_estimate(arm, monkeypatch):
    monkeypatch.setitem(NOISE, "tracker", HOPELESS)
    readings = world_readings(np.random.default_rng(2), noisy=True)
    with pytest.raises(ConvergenceError, match=r"'force-pose': after .* passes a stiffness still moves by"):
        identify_force_pose(arm, COUNTERBALANCE, readings, Options())


def test_singular_poses_are_refused(arm, rng):
    readings = world_readings(rng, noisy=False)
    straight = readings.q_motor * np.array([1, 1, 1, 1, 0, 1])
    with pytest.raises(InputError, match="every pose is singular"):
        identify_force_pose(arm, COUNTERBALANCE, replace(readings, q_motor=straight), Options())
