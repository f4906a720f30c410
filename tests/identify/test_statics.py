"""Equilibrium and sensitivities against the balance they solve, and the static world against a general root finder."""

import numpy as np
import pytest
from scipy import optimize

from bench.identify.arm import Arm
from bench.identify.statics import SecondOrder, equilibrium, link_torque, motion
from tests.identify import static_world
from tests.identify.hh150 import COUNTERBALANCE, STIFFNESS, hh150
from tests.identify.static_world import World, pushing

COMPLIANCE = 1 / STIFFNESS
BALANCE = 1e-9  # [rad], what two Newton steps may leave of 1e-3 rad
SENSITIVITY = 1e-4  # relative, of sensitivities by differences: second order of the deflection


@pytest.fixture(scope="module")
def arm():
    return Arm(hh150())


@pytest.fixture
def states(rng):
    q = np.deg2rad(rng.uniform([-180, -30, -120, -180, 20, -180], [180, 80, 20, 180, 100, 180], (12, 6)))
    wrench = np.concatenate([rng.uniform(-1500, 1500, (12, 3)), rng.uniform(-200, 200, (12, 3))], axis=1)
    return q, wrench


def settled(arm, q, wrench, compliance, second_order=SecondOrder.ALL):
    return equilibrium(arm, COUNTERBALANCE, "load", q, wrench, compliance, second_order)


def test_torque_on_the_links_is_that_of_plain_cross_products(arm, states):
    q, wrench = states
    found = link_torque(arm, COUNTERBALANCE, "load", q, q, wrench, SecondOrder.NONE)
    np.testing.assert_allclose(found.total, pushing(q, wrench), atol=1e-8)


def test_stiffness_is_the_derivative_of_the_torque(arm, states):
    q, wrench = states
    stiffness = link_torque(arm, COUNTERBALANCE, "load", q, q, wrench, SecondOrder.ALL).stiffness
    step = 1e-6
    for j, unit in enumerate(np.eye(6)):
        slope = (pushing(q + step * unit, wrench) - pushing(q - step * unit, wrench)) / (2 * step)
        np.testing.assert_allclose(stiffness[:, :, j], slope, atol=1e-3)  # [Nm/rad], of up to 1e4


def test_equilibrium_balances(arm, states):
    q, wrench = states
    torque, _ = settled(arm, q, wrench, COMPLIANCE)
    theta = q + COMPLIANCE * torque
    np.testing.assert_allclose(COMPLIANCE * torque, COMPLIANCE * pushing(theta, wrench), atol=BALANCE)


def test_without_second_order_it_is_the_torque_at_the_motor_angles(arm, states):
    q, wrench = states
    torque, load = settled(arm, q, wrench, COMPLIANCE, SecondOrder.NONE)
    np.testing.assert_allclose(torque, pushing(q, wrench), atol=1e-8)
    assert not load.stiffness.any()


def test_sensitivities_are_derivatives_of_the_position(arm, states):
    q, wrench = states

    def moved(compliance, q=q, extra=0.0):
        torque, load = equilibrium(arm, COUNTERBALANCE, "load", q, wrench, compliance, SecondOrder.ALL, 1.0, extra)
        return motion(arm, "reflector_1", q, torque, compliance, SecondOrder.ALL, load.stiffness)

    here = moved(COMPLIANCE)
    for j, unit in enumerate(np.eye(6)):
        by_compliance = 1e-3 * COMPLIANCE[j]
        up, down = moved(COMPLIANCE + by_compliance * unit), moved(COMPLIANCE - by_compliance * unit)
        slope = (up.position - down.position) / (2 * by_compliance)
        np.testing.assert_allclose(
            here.per_compliance[:, :, j], slope, atol=SENSITIVITY * np.abs(here.per_compliance[:, :, j]).max()
        )
        up, down = moved(COMPLIANCE, extra=10.0 * unit), moved(COMPLIANCE, extra=-10.0 * unit)
        np.testing.assert_allclose(
            here.per_torque[:, :, j], (up.position - down.position) / 20.0, atol=SENSITIVITY * COMPLIANCE[j]
        )
        up, down = moved(COMPLIANCE, q + 1e-5 * unit), moved(COMPLIANCE, q - 1e-5 * unit)
        np.testing.assert_allclose(
            here.per_motor_angle[:, :, j], (up.position - down.position) / 2e-5, atol=SENSITIVITY
        )


def test_the_static_world_solves_its_own_equations(rng):
    """One state of the world against scipy's root finder on the two balances with the elasto-plastic return map."""
    world = World(np.array([40.0, 150, 120, 30, 30, 8]), np.array([20.0, 90, 120, 60, 30, 8]))
    command = np.deg2rad([[10.0, 20, -50, 30, 60, 20]])
    still = np.zeros((1, 6))
    rest = static_world.settled_start(world, (command, command, still, still), command)
    wrench = np.array([[300.0, -800, -900, 0, 0, 0]])
    (q, theta, motor, link), _ = static_world.settle(world, rest, command, wrench, rng)

    def missing(x):
        q_, theta_ = x[:6], x[6:]
        f_motor = np.clip(-world.presliding * (q_ - rest[0][0]), -world.motor_level, world.motor_level)
        f_link = np.clip(-world.presliding * (theta_ - rest[1][0]), -world.link_level, world.link_level)
        spring = STIFFNESS * (q_ - theta_)
        return np.concatenate(
            [world.servo * (command[0] - q_) + f_motor - spring, spring + pushing(theta_, wrench[0]) + f_link]
        )

    start = np.concatenate([q[0], theta[0]]) + 1e-7
    root = optimize.root(missing, start, method="hybr", options={"xtol": 1e-14})
    np.testing.assert_allclose(root.x, np.concatenate([q[0], theta[0]]), atol=1e-9)
    assert np.all(np.abs(motor) <= world.motor_level)
    assert np.all(np.abs(link) <= world.link_level)
