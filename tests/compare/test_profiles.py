"""Courses of a change over the recordings."""

import numpy as np

from bench.compare.profiles import profiles_of

UNKNOWN = np.full(2, np.nan)


def test_two_recordings_leave_one_course() -> None:
    (step,) = profiles_of(1, UNKNOWN)
    assert (step.course, step.since) == ("step", 1)
    np.testing.assert_array_equal(step.weights, [0, 1])


def test_courses_of_four_recordings_after_are_all_different() -> None:
    found = profiles_of(2, np.full(6, np.nan))
    assert [one.course for one in found] == ["step"] * 4 + ["once"] * 3 + ["trend"]
    assert all(np.all(one.weights[:2] == 0) for one in found), "nothing has changed before"
    weights = np.stack([one.weights for one in found])
    assert len(np.unique(weights, axis=0)) == len(found)


def test_a_trend_grows_with_time_where_that_is_known() -> None:
    days = np.array([0.0, 7.0, 10.0, 28.0])
    trend = profiles_of(1, days)[-1]
    np.testing.assert_allclose(trend.weights, days / 28)
    assert trend.days == 28


def test_a_trend_begins_with_the_last_recording_before() -> None:
    trend = profiles_of(2, np.array([0.0, 10.0, 12.0, 14.0, 18.0]))[-1]
    np.testing.assert_allclose(trend.weights, [0, 0, 0.25, 0.5, 1])


def test_two_recordings_after_have_no_trend() -> None:
    assert "trend" not in [one.course for one in profiles_of(1, np.array([0.0, 1.0, 2.0]))]


def test_a_trend_begins_with_the_last_recording_before_in_whatever_order_they_are_given() -> None:
    """A recording before had a quarter of the change."""
    trend = profiles_of(2, np.array([5.0, 0.0, 7.0, 14.0, 21.0]))[-1]
    np.testing.assert_allclose(trend.weights, [0, 0, 2 / 16, 9 / 16, 1])
