"""The play element against the return map of a rigid-plastic friction element, step by step."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.identify.play import play
from tests.identify.readings import bare_readings


def element(torques, level=10.0, approach=0):
    readings = bare_readings(len(torques), 1, approach=approach)
    return play(readings, np.array(torques, dtype=float)[:, None], np.array([level]))


def test_it_takes_up_what_the_load_changes_then_slides():
    found = element([0, 4, 8, 12, 20, 18, 5, -1])
    np.testing.assert_allclose(found.torque[:, 0], [0, 4, 8, 10, 10, 8, -5, -10])
    np.testing.assert_array_equal(found.slides[:, 0], [0, 0, 0, 1, 1, 0, 0, 1])
    np.testing.assert_array_equal(found.direction[:, 0], [0, 0, 0, 1, 1, 1, 1, -1])


def test_an_approach_leaves_it_sliding_its_way():
    up = element([0, 5, 30], approach=1)
    np.testing.assert_allclose(up.torque[:, 0], [10, 10, 10])
    down = element([0, 5, 15, 30], approach=-1)
    np.testing.assert_allclose(down.torque[:, 0], [-10, -5, 5, 10])
    np.testing.assert_array_equal(down.direction[:, 0], [-1, -1, -1, 1])


def test_series_do_not_know_of_each_other():
    readings = bare_readings(4, 1, series=[0, 0, 1, 1])
    found = play(readings, np.array([[0.0], [50], [0], [5]]), np.array([10.0]))
    np.testing.assert_allclose(found.torque[:, 0], [0, 10, 0, 5])


@given(
    torques=st.lists(st.floats(-100, 100), min_size=2, max_size=20),
    level=st.floats(0.1, 50),
    approach=st.sampled_from([-1, 0, 1]),
)
def test_it_stays_within_its_level_and_never_pushes(torques, level, approach):
    found = element(torques, level, approach)
    assert np.all(np.abs(found.torque) <= level)
    step, change = np.diff(torques), np.diff(found.torque[:, 0])
    assert np.all(change * step >= 0), "friction opposes"
    assert np.all(np.abs(change) <= np.abs(step) + 1e-12), "and never by more than the load changed"


def test_its_direction_is_its_derivative_by_the_level():
    torques, h = [0, 30, 60, 30, -30, 5, 20], 1e-6
    slope = (element(torques, 10 + h, 1).torque - element(torques, 10 - h, 1).torque) / (2 * h)
    np.testing.assert_allclose(slope, element(torques, 10.0, 1).direction, atol=1e-6)


def test_without_a_level_there_is_no_friction():
    assert element([0, 10, -10], level=0.0).torque == pytest.approx(0)
