"""What currents and load say together, on series whose friction is written down."""

import numpy as np
import pytest

from bench.identify.friction import LOAD_DEPENDENT, friction_change
from tests.identify.readings import bare_readings

UP_AND_DOWN = np.array([0.0, 400, 700, 1000, 1400, 1000, 700, 400, 0])
UP = UP_AND_DOWN[:5]
GAIN = 0.03  # by which the load's torque exceeds the current's
LEVEL = 80.0  # [Nm]


def compared(ladder, *, series=6, gain=GAIN, level=LEVEL, load_dependent=0.0):
    """Return the comparison for one joint, approached from below; friction of all series slides from the start."""
    direction = np.sign(np.diff(ladder, prepend=-1.0))
    friction = direction * (level + load_dependent * ladder)
    current = np.tile((ladder - friction) / (1 + gain), series)
    gamma = np.tile(ladder, series)
    readings = bare_readings(
        len(gamma), 1, series=np.repeat(np.arange(series), len(ladder)), approach=1, current_torque=-current[:, None]
    )
    none = np.zeros((len(gamma), 1))
    return friction_change(readings, gamma[:, None], 0.2 + none, np.zeros((len(gamma), 1, 3)))


def test_friction_is_what_load_and_current_differ_by():
    found = compared(UP_AND_DOWN, gain=0.0)
    np.testing.assert_allclose(np.abs(found.total[5:9, 0]), 2 * LEVEL, rtol=0.01)
    np.testing.assert_allclose(found.total[1:5, 0], 0.0, atol=1.0)


def test_a_reversal_tells_gain_from_load_dependent_friction():
    for load_dependent in (0.0, 0.05):
        found = compared(UP_AND_DOWN, load_dependent=load_dependent)
        assert found.gain[0] == pytest.approx(GAIN, abs=1e-3)
        assert found.gain_sigma[0] < 1e-3


def test_without_reversal_the_priors_share_the_slope():
    """Gain and load-dependent friction do the same to a rising ladder; the slope goes where its prior is wider."""
    found = compared(UP, load_dependent=0.0)
    prior = np.hypot(0.02, 0.005)
    expected = GAIN * prior**2 / (prior**2 + LOAD_DEPENDENT**2)
    assert found.gain[0] == pytest.approx(expected, rel=0.05)
    assert found.gain_sigma[0] == pytest.approx(prior * LOAD_DEPENDENT / np.hypot(prior, LOAD_DEPENDENT), rel=0.05)


def test_a_load_that_pulls_elsewhere_moves_the_gain():
    """The gain's derivative by the direction of the load, against two comparisons with turned loads."""
    ladder, series, turn = UP_AND_DOWN, 6, 1e-3
    current = np.tile(ladder - LEVEL * np.sign(np.diff(ladder, prepend=-1.0)), series)[:, None]
    gamma = np.tile(ladder, series)[:, None]
    readings = bare_readings(
        len(gamma), 1, series=np.repeat(np.arange(series), len(ladder)), approach=1, current_torque=-current
    )
    by_direction = np.concatenate([0.3 * gamma, np.zeros_like(gamma), np.zeros_like(gamma)], axis=1)[:, None, :]
    sigma = np.full_like(gamma, 0.2)
    found = friction_change(readings, gamma, sigma, by_direction)
    turned = friction_change(readings, gamma + turn * by_direction[..., 0], sigma, by_direction)
    assert turned.gain[0] - found.gain[0] == pytest.approx(turn * found.gain_by_direction[0, 0], rel=0.05)


def test_little_load_may_stick():
    found = compared(np.array([0.0, 400, 390, 0, 100]), gain=0.0)
    np.testing.assert_array_equal(found.may_stick[1:5, 0], [False, True, False, True])


def test_no_load_no_friction():
    found = compared(np.zeros(5), level=0.0)
    assert found.scale[0] == 0
    assert found.gain[0] == 0
    assert found.gain_sigma[0] == pytest.approx(np.hypot(0.02, 0.005))
