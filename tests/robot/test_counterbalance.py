"""The counterbalance against its geometry, finite differences, the paper's own form of Eqs. (9) to (12), and energy."""

from dataclasses import replace

import numpy as np
import pytest

from bench.errors import RobotError
from bench.robot.counterbalance import Counterbalance

DEGREE = np.pi / 180
A, H, B = 0.04029, 0.69884, 0.2  # [m], reference geometry of models/hh150/paper/parameters.json
CBS = Counterbalance(1, float(np.hypot(A, H)), B, 3.3 * DEGREE, 4771.4, 0.9112)
THETA = np.linspace(-40, 110, 31) * DEGREE
STEP = 1e-6  # [rad]; central differences
RELATIVE = 1e-7  # of a difference over 2e-6 rad: rounding 1e-16 / 1e-6, curvature 1e-12
ROUNDING = 1e-12


def slope(function):
    return (function(THETA + STEP) - function(THETA - STEP)) / (2 * STEP)


def test_length_is_the_distance_of_two_anchors_on_circles():
    fixed = CBS.rho * np.array([np.sin(CBS.dead_centre), np.cos(CBS.dead_centre)])
    moving = CBS.b * np.stack([np.sin(THETA), np.cos(THETA)], axis=1)
    np.testing.assert_allclose(CBS.length(THETA), np.linalg.norm(moving - fixed, axis=1), rtol=ROUNDING)


def test_lever_arm_and_stiffness_are_derivatives():
    np.testing.assert_allclose(CBS.lever_arm(THETA), slope(CBS.length), atol=RELATIVE * CBS.b)
    np.testing.assert_allclose(CBS.stiffness(THETA), slope(CBS.torque), atol=RELATIVE * 1e4)


def test_torque_is_the_derivative_of_the_work_of_the_gas():
    """Pulling the rod out by dl costs F dl, F = C / (l_c - l): energy -C ln(l_c - l)."""
    np.testing.assert_allclose(
        CBS.torque(THETA),
        slope(lambda theta: -CBS.gas_constant * np.log(CBS.critical_length - CBS.length(theta))),
        atol=RELATIVE * 1e4,
    )


def test_it_is_the_form_the_paper_prints():
    """Eqs. (9), (11) and (12) in the DH angle theta - 90 deg, tan(alpha) = a / h."""
    alpha, rho, c, l_c = np.arctan2(A, H), np.hypot(A, H), CBS.gas_constant, CBS.critical_length
    assert alpha == pytest.approx(CBS.dead_centre, abs=1e-4)
    same = replace(CBS, dead_centre=alpha)
    turned = alpha - (THETA - np.pi / 2)
    length = np.sqrt(B**2 + rho**2 - 2 * B * rho * np.sin(turned))
    torque = c * B * rho * np.cos(turned) / (length * (l_c - length))
    # Eq. (12) prints the derivative of Eq. (11) in two terms
    first = c * B * rho * np.sin(turned) / (length * (l_c - length))
    second = c * B**2 * rho**2 * (l_c - 2 * length) * np.cos(turned) ** 2 / (length**3 * (l_c - length) ** 2)
    np.testing.assert_allclose(same.length(THETA), length, rtol=ROUNDING)
    np.testing.assert_allclose(same.torque(THETA), torque, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(same.stiffness(THETA), first - second, rtol=1e-9, atol=1e-6)


def test_it_restores_towards_the_dead_centre():
    assert CBS.torque(CBS.dead_centre) == pytest.approx(0, abs=1e-9)
    assert np.all(np.sign(CBS.torque(THETA)) == np.sign(THETA - CBS.dead_centre))
    np.testing.assert_allclose(
        CBS.torque(CBS.dead_centre + THETA), -CBS.torque(CBS.dead_centre - THETA), rtol=1e-9, atol=1e-9
    )


def test_the_reference_geometry_gives_the_reconstructed_torques():
    np.testing.assert_allclose(CBS.torque(np.array([40, 60, 90, 110]) * DEGREE), [2000, 3100, 4800, 6300], rtol=0.02)


def test_without_gas_volume_there_is_no_force():
    short = replace(CBS, critical_length=0.7)
    force = short.force(THETA)
    assert np.all(np.isnan(force) == (short.length(THETA) >= 0.7))
    assert np.isnan(force).any()


def test_impossible_figures_are_all_named():
    with pytest.raises(RobotError) as caught:
        Counterbalance(1, -0.7, 0.2, 0.0, 0.0, 0.1)
    assert len(caught.value.problems) == 3
    assert "rho" in caught.value.problems[0]
    assert "gas_constant" in caught.value.problems[1]
    assert "critical_length" in caught.value.problems[2]
    with pytest.raises(RobotError, match="rho equals b"):
        Counterbalance(1, 0.2, 0.2, 0.0, 1.0, 1.0)
