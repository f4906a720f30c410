"""How numbers, units, channels and places are called."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.diagnose.verdict import NamedCause, ParameterValue, PredictedError, Unlisted
from bench.report.diagnosis.names import (
    cause_name,
    cause_names,
    channel_name,
    error_text,
    meaning_of,
    name_beside,
    parameter_text,
    place_name,
    unlisted_name,
)
from bench.report.diagnosis.numbers import gain_percent, percent, shown
from tests.report.diagnosis.made import GAS, MASS, WARM, ZERO, explanation

ROUNDING = 0.0501  # of a step of which two digits are shown: half of the second one
DOUBLE = 1e-14  # relative; no more digits are shown than a double has


def test_what_to_expect_is_in_the_unit_that_stands_beside_it() -> None:
    error = PredictedError("q_link_1_rad", "rad", "motion", 4, 1.9e-4, 1.1e-4, 3.3e-4)
    assert error_text(error) == "link angle 1: 0.0109 deg, and 0.0063 to 0.0189 deg in the next recording"
    force = replace(error, channel="tau_motor_1_n", unit="N", rms=4.48, low=2.61, high=6.94)
    assert error_text(force) == "motor force 1: 4.48 N, and 2.61 to 6.94 N in the next recording"


@pytest.mark.parametrize(
    ("column", "name"),
    [
        ("current_2_a", "motor current 2"),
        ("tau_motor_3_nm", "motor torque 3"),
        ("tau_motor_1_n", "motor force 1"),
        ("q_link_2_m", "link position 2"),
        ("reflector_1_x_m", "reflector 1 x"),
        ("gas_pressure_pa", "gas pressure"),
        ("oil_level_m", "oil_level_m"),
    ],
)
def test_channels_have_names(column: str, name: str) -> None:
    assert channel_name(column) == name


@pytest.mark.parametrize(
    ("words", "meaning"),
    [
        ("f_C; range for a drive of 10 kNm", "f_C"),
        ("range for a drive of 10 kNm", ""),
        ("s; 10 to 60 arcsec", "s; 10 to 60 arcsec"),
    ],
)
def test_the_range_of_another_drive_is_not_told(words: str, meaning: str) -> None:
    assert meaning_of(ParameterValue("level", 20.0, 19.0, 21.0, "N", words)) == meaning


@pytest.mark.parametrize(
    ("value", "low", "high", "unit", "text"),
    [
        (0.1326, 0.1127, 0.1525, "", "x 0.133 (0.113 to 0.152)"),
        (3.1e-4, 2.2e-4, 4.0e-4, "rad", "x 0.0178 deg (0.0126 to 0.0229)"),
        (2.9e-3, 1.2e-3, 4.6e-3, "m", "x 2.9 mm (1.2 to 4.6)"),
        (-38.4, -44.2, -32.6, "K", "x -38.4 K (-44.2 to -32.6)"),
        (3.2e7, 2.9e7, 3.5e7, "Nm/rad", "x 3.2e+07 Nm/rad (2.9e+07 to 3.5e+07)"),
        (3.2e7, 3.19e7, 3.21e7, "Nm/rad", "x 3.2e+07 Nm/rad (3.19e+07 to 3.21e+07)"),
        (1.6e-7, 1.5e-7, 1.7e-7, "rad/Nm", "x 1.6e-07 rad/Nm (1.5e-07 to 1.7e-07)"),
        (1.6e-7, -2e-8, 3.4e-7, "rad/Nm", "x 1.6e-07 rad/Nm (-2e-08 to 3.4e-07)"),
        (0.0, -1.4e-8, 1.4e-8, "rad/Nm", "x 0 rad/Nm (-1.4e-08 to 1.4e-08)"),
        (1.0, 1.0, 1.0, "", "x 1.000 (1.000 to 1.000)"),
        (1.6e-7, 1.6e-7, 1.6e-7, "", "x 1.6e-07 (1.6e-07 to 1.6e-07)"),
        (0.0, 0.0, 0.0, "", "x 0.000 (0.000 to 0.000)"),
    ],
)
def test_digits_follow_the_interval(value: float, low: float, high: float, unit: str, text: str) -> None:
    assert parameter_text(ParameterValue("x", value, low, high, unit)) == text


@pytest.mark.parametrize("share", [1e-3, 0.03, 0.5])
@pytest.mark.parametrize("power", range(-9, 10))
def test_intervals_keep_their_digits_from_1e_9_to_1e9(power: int, share: float) -> None:
    value, half = 1.6 * 10.0**power, 1.6 * 10.0**power * share
    texts = shown((value, value - half, value + half), "A", half)
    assert len(set(texts)) == 3
    for text, number in zip(texts, (value, value - half, value + half), strict=True):
        assert abs(float(text) - number) <= ROUNDING * half


@given(st.floats(-1e9, 1e9), st.floats(1e-9, 1e6))
def test_what_is_shown_is_near_the_value(value: float, resolution: float) -> None:
    (text,) = shown((value,), "A", resolution)
    assert abs(float(text) - value) <= max(ROUNDING * resolution, DOUBLE * abs(value))


@pytest.mark.parametrize(("share", "text"), [(-1.8e-7, "> -0.1 %"), (3e-4, "< 0.1 %"), (-0.0067, "-0.67 %")])
def test_a_share_of_nearly_nothing_has_no_exponent(share: float, text: str) -> None:
    assert percent(share) == text


@pytest.mark.parametrize(
    ("share", "text"),
    [(-1.8e-7, "0.0 %"), (3e-4, "0.0 %"), (-0.0067, "-0.7 %"), (0.834, "83 %"), (float("nan"), "-")],
)
def test_a_gain_is_said_to_a_tenth_of_a_percent(share: float, text: str) -> None:
    assert gain_percent(share) == text


@given(st.floats(0, 1, exclude_min=True, exclude_max=True))
def test_no_probability_is_rounded_to_certainty(share: float) -> None:
    assert percent(share) not in ("0 %", "100 %")


@pytest.mark.parametrize(
    ("place", "name"),
    [
        ("robot in recording may", "loss of gas (in recording may)"),
        ("drive 2 in recording may_3", "loss of gas (drive 2 in recording may_3)"),
        ("current_2_a in recording may_3", "loss of gas (motor current 2 in recording may_3)"),
    ],
)
def test_a_place_in_one_recording_is_named_with_it(place: str, name: str) -> None:
    assert cause_name(replace(GAS, place=place)) == name


@pytest.mark.parametrize(
    ("place", "words"),
    [
        ("current_6_a from run svc_1 on", "motor current 6 from run svc_1 on"),
        ("robot from run four_2 on", "from run four_2 on"),
        ("run ptp_2", "run ptp_2"),
        ("current_2_a in recording may_1", "motor current 2 in recording may_1"),
    ],
)
def test_names_of_runs_stay_whole(place: str, words: str) -> None:
    assert place_name(place) == words


def test_one_cause_in_many_joints_is_named_once() -> None:
    rubs = tuple(NamedCause("coulomb_level", "Coulomb level", f"joint {i}", ()) for i in (3, 1, 2))
    zero = NamedCause("joint_zero", "zero of a joint", "joint 2", ())
    assert cause_names((rubs[0], MASS, *rubs[1:], zero)) == [
        "Coulomb level (joints 1, 2 and 3)",
        "mass of a link (upper arm)",
        "zero of a joint (joint 2)",
    ]


def test_a_channel_that_is_wrong_is_called_as_people_call_it() -> None:
    assert cause_name(NamedCause("channel_scale", "scale", "current_5_a", ())) == "scale (motor current 5)"
    assert cause_name(NamedCause("channel_delay", "delay", "tracker", ())) == "delay (tracker)"


def test_a_rival_with_much_in_common_is_told_by_its_difference() -> None:
    best = explanation((GAS, ZERO, MASS), 0.9, 90.0)
    other = explanation((WARM, ZERO, MASS), 0.1, 88.0)
    assert name_beside(other, best) == "the same with gas warmer or colder in place of loss of gas"
    assert name_beside(explanation((GAS, ZERO), 0.0, 1.0), best) == "the same without mass of a link (upper arm)"
    assert name_beside(best, explanation((GAS, ZERO), 0.0, 1.0)) == "the same with mass of a link (upper arm) too"
    assert name_beside(explanation((WARM,), 0.1, 1.0), best) == "gas warmer or colder"
    assert name_beside(best, best) == "loss of gas with zero of a joint (joint 2) with mass of a link (upper arm)"


def test_on_a_slide_there_are_forces_and_positions() -> None:
    force = ParameterValue("at_1", -10.2, -12.7, -7.7, "N", "at 0.035 m/s")
    shape = Unlisted("joint 1", "link torque", "angle", (force,))
    assert unlisted_name(shape) == "a force on the link of joint 1 that depends on position"
    assert unlisted_name(replace(shape, parameters=(replace(force, unit="Nm"),))).startswith("a torque on the link")
