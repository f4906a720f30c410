"""What is said on the terminal, and how numbers and channels are called."""

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.diagnose.verdict import Explanation, NamedCause, NoisyChannel, ParameterValue
from bench.report.diagnosis.names import cause_names, channel_name, name_beside, parameter_text, percent, shown
from bench.report.diagnosis.words import places_of, words_of
from tests.report.diagnosis.made import GAS, MASS, NO_GAIN, NOTHING, VERDICTS, WARM, ZERO


@pytest.mark.parametrize(
    ("kind", "first"),
    [
        ("nothing", "Nothing found: the nominal model explains this campaign."),
        ("cause", "Loss of gas: lost 0.133 (95 % interval 0.113 to 0.152)."),
        ("several", "2 causes act together: loss of gas and zero of a joint (joint 2)."),
        (
            "unlisted",
            "An unlisted cause: a torque on the motor of joint 2 that depends on angle and direction, which no effect "
            "of the catalogue explains.",
        ),
    ],
)
def test_the_first_line_is_the_verdict(kind: str, first: str) -> None:
    assert next(words_of(VERDICTS[kind])) == first


def test_a_cause_comes_with_its_worth_and_what_to_do() -> None:
    text = "\n".join(words_of(VERDICTS["cause"]))
    for words in (
        "lost 0.133 (0.113 to 0.152)",
        "motor current 2: 0.612 -> 0.081 A (floor 0.074), gain 87 % (83 % to 90 %)",
        "Refused: mass of a link (upper arm): held-out runs do not become more probable.",
        "Next: the sweeps again, slower",
        "variance is 1.7 times",
        "Not looked for without gear temperatures (gear_temperature_i_k): friction temperature.",
    ):
        assert words in text


def test_a_climb_is_told_step_by_step() -> None:
    first = VERDICTS["cause"].steps[0]
    steps = (first, replace(first, added=(MASS,), log_evidence=7.0, channels=(NO_GAIN,)))
    lines = list(words_of(replace(VERDICTS["cause"], steps=steps)))
    assert "  loss of gas: +94, held out +81 (60 to 103); motor current 2 0.612 -> 0.081 A" in lines
    assert "  mass of a link (upper arm): +7, held out +81 (60 to 103)" in lines


def test_one_cause_in_many_joints_is_named_once() -> None:
    rubs = tuple(NamedCause("coulomb_level", "Coulomb level", f"joint {i}", ()) for i in (3, 1, 2))
    zero = NamedCause("joint_zero", "zero of a joint", "joint 2", ())
    assert cause_names((rubs[0], MASS, *rubs[1:], zero)) == [
        "Coulomb level (joints 1, 2 and 3)",
        "mass of a link (upper arm)",
        "zero of a joint (joint 2)",
    ]


def test_a_rival_with_much_in_common_is_told_by_its_difference() -> None:
    best = Explanation((GAS, ZERO, MASS), 0.9, 90.0)
    other = Explanation((WARM, ZERO, MASS), 0.1, 88.0)
    assert name_beside(other, best) == "the same with gas warmer or colder in place of loss of gas"
    assert name_beside(Explanation((GAS, ZERO), 0.0, 1.0), best) == "the same without mass of a link (upper arm)"
    assert name_beside(best, Explanation((GAS, ZERO), 0.0, 1.0)) == "the same with mass of a link (upper arm) too"
    assert name_beside(Explanation((WARM,), 0.1, 1.0), best) == "gas warmer or colder"
    assert name_beside(best, best) == "loss of gas with zero of a joint (joint 2) with mass of a link (upper arm)"


def test_a_set_is_not_guessed_between() -> None:
    text = "\n".join(words_of(VERDICTS["set"]))
    assert "either loss of gas or gas warmer or colder, which these data cannot tell apart" in text
    assert "It would decide between loss of gas and gas warmer or colder" in text


def test_nothing_found_says_what_would_have_been() -> None:
    text = "\n".join(words_of(VERDICTS["nothing"]))
    assert "chance would still find something in 1 % of such campaigns" in text
    assert "joint zero, joint 2: offset 0.012 deg" in text


def test_nothing_found_in_a_channel_that_is_all_noise_is_not_praised() -> None:
    noisy = (NoisyChannel("current_6_a", True, 174.0), *(NoisyChannel(f"current_{i}_a", False, 4.0) for i in (1, 2, 3)))
    lines = list(words_of(replace(NOTHING, noise_scale=31.0, noisy=noisy)))
    assert lines[0] == "Nothing found, but motor current 6 scatters 174 times as much as its instrument."
    (scatter,) = (line for line in lines if line.startswith("The data scatter"))
    assert "motor current 6 in motion by 174 times its instrument's error, motor current 1 at rest by 4" in scatter
    assert "and 1 more" in scatter


def test_files_are_named(tmp_path: Path) -> None:
    assert not any("model" in line for line in places_of(tmp_path))
    (tmp_path / "extended.xml").touch()
    assert any(str(tmp_path / "extended.xml") in line for line in places_of(tmp_path))


@pytest.mark.parametrize(
    ("column", "name"),
    [
        ("current_2_a", "motor current 2"),
        ("tau_motor_3_nm", "motor torque 3"),
        ("reflector_1_x_m", "reflector 1 x"),
        ("gas_pressure_pa", "gas pressure"),
        ("oil_level_m", "oil_level_m"),
    ],
)
def test_channels_have_names(column: str, name: str) -> None:
    assert channel_name(column) == name


@pytest.mark.parametrize(
    ("value", "low", "high", "unit", "text"),
    [
        (0.1326, 0.1127, 0.1525, "", "x 0.133 (0.113 to 0.152)"),
        (3.1e-4, 2.2e-4, 4.0e-4, "rad", "x 0.0178 deg (0.0126 to 0.0229)"),
        (2.9e-3, 1.2e-3, 4.6e-3, "m", "x 2.9 mm (1.2 to 4.6)"),
        (-38.4, -44.2, -32.6, "K", "x -38.4 K (-44.2 to -32.6)"),
        (3.2e7, 2.9e7, 3.5e7, "Nm/rad", "x 3.2e+07 Nm/rad (2.9e+07 to 3.5e+07)"),
        (1.0, 1.0, 1.0, "", "x 1.000 (1.000 to 1.000)"),
    ],
)
def test_digits_follow_the_interval(value: float, low: float, high: float, unit: str, text: str) -> None:
    assert parameter_text(ParameterValue("x", value, low, high, unit)) == text


@given(st.floats(-1e9, 1e9), st.floats(1e-6, 1e6))
def test_what_is_shown_is_near_the_value(value: float, resolution: float) -> None:
    (text,) = shown((value,), "A", resolution)
    assert abs(float(text) - value) <= max(0.1 * resolution, 1e-2 * abs(value), 1e-6)


@given(st.floats(0, 1, exclude_min=True, exclude_max=True))
def test_no_probability_is_rounded_to_certainty(share: float) -> None:
    assert percent(share) not in ("0 %", "100 %")
