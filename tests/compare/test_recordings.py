"""Which recordings are compared, in which order."""

from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest

from bench.compare.recordings import days_of, recordings_of
from bench.errors import CampaignError
from bench.record.campaign import Campaign, Run
from bench.record.known import Known

RUN = Run("sweep", "motion", 0.0, {"time_s": np.arange(3.0), "q_motor_1_rad": np.arange(3.0)})
PLAIN = Campaign("hh150", (RUN,))


def at(day: int) -> Campaign:
    return replace(PLAIN, started=datetime(2024, 5, day))


def test_recordings_after_stand_in_the_order_of_their_time() -> None:
    found = recordings_of({"a": at(1)}, {"c": at(9), "b": at(3)})
    assert [one.name for one in found] == ["a", "b", "c"]
    assert [one.is_after for one in found] == [False, True, True]
    np.testing.assert_allclose(days_of(found), [0, 2, 8])


def test_without_times_the_order_given_holds() -> None:
    found = recordings_of({"a": at(1)}, {"c": at(9), "b": PLAIN})
    assert [one.name for one in found] == ["a", "c", "b"]
    assert np.all(np.isnan(days_of(found)))


def test_recordings_of_one_campaign_before_are_repeats() -> None:
    runs = (replace(RUN, recording="may"), replace(RUN, name="again", recording="june"))
    found = recordings_of({"a": replace(PLAIN, runs=runs)}, {"b": PLAIN})
    assert [(one.name, one.is_after) for one in found] == [("a.may", False), ("a.june", False), ("b", True)]


def test_runs_of_a_recording_need_no_name_of_one() -> None:
    """A change of a recording within a campaign was looked for in "recording may", beside the machine's own."""
    runs = (replace(RUN, recording="may"), replace(RUN, name="again", recording="june"))
    named = replace(PLAIN, runs=runs[:1])
    found = recordings_of({"a": replace(PLAIN, runs=runs)}, {"b": named})
    assert [one.name for one in found] == ["a.may", "a.june", "b"]
    assert [run.recording for one in found for run in one.campaign.runs] == ["", "", ""]


def test_a_payload_that_the_lab_weighed_is_what_runs_carry() -> None:
    """It was ignored, and named as a payload that had changed."""
    known = tuple(Known("payload_kg", mass, 0.1, recording=name) for name, mass in (("may", 80.0), ("june", 0.0)))
    runs = (replace(RUN, recording="may"), replace(RUN, name="again", recording="june"))
    found = recordings_of({"a": replace(PLAIN, runs=runs, known=known)}, {"b": replace(PLAIN, known=known[:1])})
    carried = [one.campaign.runs[0].columns.get("load_mass_kg") for one in found]
    np.testing.assert_array_equal(carried[0], np.full(3, 80.0))
    assert carried[1] is None
    assert carried[2] is None, "its reading is of a recording of another name"


def test_gas_whose_temperature_is_known_has_a_thermometer() -> None:
    """It was not used, and gas that was colder may have been lost. What is known badly is not."""
    well, badly = (Known("gas_temperature_k", 291.0, sigma) for sigma in (0.5, 4.0))
    logged = replace(RUN, columns={**RUN.columns, "gas_temperature_k": np.full(3, 295.0)})
    campaigns = {
        "well": replace(PLAIN, known=(well,)),
        "badly": replace(PLAIN, known=(badly,)),
        "logged": replace(PLAIN, runs=(logged,), known=(well,)),
    }
    found = {one.name: one.campaign.runs[0].columns for one in recordings_of({"a": PLAIN}, campaigns)}
    np.testing.assert_array_equal(found["well"]["gas_temperature_k"], np.full(3, 291.0))
    assert "gas_temperature_k" not in found["badly"]
    np.testing.assert_array_equal(found["logged"]["gas_temperature_k"], np.full(3, 295.0))


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ({}, {"b": PLAIN}, "a recording before"),
        ({"a": PLAIN}, {}, "at least one after"),
        ({"a": PLAIN}, {"a": PLAIN}, "the same name"),
        ({"a": PLAIN}, {"b": replace(PLAIN, robot="kr300")}, "different robots"),
    ],
)
def test_what_cannot_be_compared_is_said(before: dict, after: dict, words: str) -> None:
    with pytest.raises(CampaignError, match=words):
        recordings_of(before, after)
