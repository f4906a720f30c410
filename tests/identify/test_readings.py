"""Readings refuse what does not fit together, and methods what they cannot use."""

from dataclasses import replace

import numpy as np
import pytest

from bench.errors import InputError
from bench.identify.channels import usable
from bench.identify.outcome import SIGNAL_TO_NOISE, excludes_rigid, is_signal
from tests.identify.readings import bare_readings

DOWN = np.array([0.0, 0.0, -9.81])


def test_all_faults_are_named_at_once():
    with pytest.raises(InputError) as caught:
        bare_readings(4, 2, wrench=np.zeros((4, 3)), sigma_current_torque=np.zeros(3))
    assert len(caught.value.problems) == 2
    assert "wrench has shape (4, 3), expected (4, 6)" in caught.value.problems[0]


def test_a_series_needs_an_unloaded_state():
    with pytest.raises(InputError, match="series 1 has no unloaded state"):
        bare_readings(4, 2, series=[0, 0, 1, 1], is_reference=np.array([True, False, False, False]))


def test_motor_angles_are_not_missing():
    with pytest.raises(InputError, match="q_motor has missing values"):
        bare_readings(2, 1, q_motor=np.array([[0.0], [np.nan]]))


def test_a_hanging_load_pulls_along_gravity():
    wrench = np.array([[3.0, -4, -1000, 5, 5, 5], [300.0, -4, -1000, 5, 5, 5]])
    readings = bare_readings(2, 1, wrench=wrench, is_vertical=np.array([True, False]))
    np.testing.assert_allclose(readings.load(DOWN), [[0, 0, -1000, 0, 0, 0], wrench[1]])


def test_states_without_a_channel_are_dropped_with_their_series():
    current = np.ones((6, 1))
    current[[1, 3]] = np.nan
    readings = bare_readings(6, 1, series=[0, 0, 0, 1, 1, 1], current_torque=current)
    kept = usable("current", readings, "current", "reflector")
    np.testing.assert_array_equal(kept.series, [0, 0])
    assert kept.first_of_series.tolist() == [0, 0]


def test_a_channel_without_any_complete_series_is_named():
    current = np.ones((4, 1))
    current[0] = np.nan
    readings = bare_readings(4, 1, current_torque=current)
    with pytest.raises(InputError, match="needs a series with motor currents"):
        usable("current", readings, "current")
    blind = replace(readings, reflectors=np.full((4, 1, 3), np.nan))
    with pytest.raises(InputError, match=r"needs a reflector at the reference point \(reflector_1_x_m"):
        usable("force", blind, "force", "reflector")


def test_noise_alone_is_no_signal(rng):
    sigma = np.array([2.0, 2.0, 2.0])
    change = sigma * rng.standard_normal((50, 3)) * np.array([1.0, 1.0, 0.0])
    change[:, 1] += 2 * SIGNAL_TO_NOISE * sigma[1]
    np.testing.assert_array_equal(is_signal(change, sigma), [False, True, False])
    np.testing.assert_array_equal(is_signal(np.zeros((5, 2)), np.zeros(2)), [False, False])


def test_a_joint_is_observed_when_rigid_is_excluded():
    sigma = np.diag([0.4, 0.6]) ** 2
    np.testing.assert_array_equal(excludes_rigid(np.ones(2), sigma), [True, False])


def test_among_loaded_states_the_first_load_is_what_others_are_held_against():
    readings = bare_readings(7, 1, series=[0, 0, 0, 1, 1, 2, 2], q_motor=np.arange(7.0)[:, None])
    reference = readings.is_reference.copy()
    reference[6] = True  # series 2 was only read unloaded
    found = replace(readings, is_reference=reference).among_loaded()
    np.testing.assert_array_equal(found.q_motor[:, 0], [1, 2])
    np.testing.assert_array_equal(found.is_reference, [True, False])
    with pytest.raises(InputError, match="under two loads"):
        readings.take(readings.series == 1).among_loaded()
