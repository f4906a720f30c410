"""What is said on the terminal."""

from dataclasses import replace
from pathlib import Path

import pytest

from bench.diagnose.verdict import (
    AmbiguityGroup,
    DetectionLimit,
    NoisyChannel,
    PossibleCause,
    Proposal,
    RecordingGain,
    Step,
    UndetectableEffect,
)
from bench.report.diagnosis.headline import headline
from bench.report.diagnosis.names import cause_name
from bench.report.diagnosis.sentences import (
    confirmed_text,
    gain_sentence,
    gain_text,
    proposal_text,
    refused_text,
    step_text,
    undetectable_sentence,
)
from bench.report.diagnosis.words import places_of, words_of
from tests.report.diagnosis.made import GAS, MASS, NO_GAIN, NOTHING, VERDICTS, WARM, ZERO, explanation


def test_what_is_undetectable_in_some_recordings_is_a_sentence() -> None:
    limit = DetectionLimit("tracker_frame", "robot in recording may", "tx", 2.0, "m", 2.0, 1e-3, 1)
    both = (limit, replace(limit, place="robot in recording june"), replace(limit, effect="zero", place="joint 2"))
    assert undetectable_sentence(replace(NOTHING, detectable=both)) == (
        "Not detectable at a plausible size: frame of the laser tracker (in recordings may and june): tx; "
        "zero (joint 2): tx."
    )


def test_two_causes_in_the_place_of_one_are_another_explanation() -> None:
    other = explanation((MASS, ZERO), 0.4, 90.0)
    one = replace(VERDICTS["cause"], explanations=(*VERDICTS["cause"].explanations, other))
    assert headline(one) == "Loss of gas, or another explanation, which these data cannot tell apart."
    assert any("altogether: mass of a link (upper arm) with zero of a joint" in line for line in words_of(one))


def test_a_cause_that_no_fitted_model_has_says_so() -> None:
    """A diagnosis that ended early named a payload without a size and without a word."""
    named = replace(GAS, parameters=())
    group = AmbiguityGroup((PossibleCause(named, 1.0),), 1.0)
    said = list(words_of(replace(VERDICTS["cause"], findings=(group,))))
    place = next(i for i, line in enumerate(said) if line.strip().startswith("100 %"))
    assert said[place + 1].strip().startswith("no model with it was fitted: its size is not known")


def test_a_cause_comes_with_its_worth_and_what_to_do() -> None:
    text = "\n".join(words_of(VERDICTS["cause"]))
    for words in (
        "lost 0.133 (0.113 to 0.152)",
        "motor current 2: 0.405 -> 0.081 A of 2.310 measured (nominal fitted 0.612, floor 0.074), "
        "gain 80 % (74 % to 86 %)",
        "Refused: mass of a link (upper arm): held-out runs do not become more probable.",
        "Next: the sweeps again, slower",
        "variance is 1.7 times",
        "Not looked for without gear temperatures (gear_temperature_i_k): friction falls with gear temperature.",
    ):
        assert words in text


def test_what_the_lab_knows_is_no_channel_that_is_predicted_better() -> None:
    """A payload as known stood there as "0.000 -> 0.054 kg", an earlier diagnosis with the unit 1."""
    (better, _, worse), known = VERDICTS["cause"].gain, replace(NO_GAIN, channel="known_payload_1", over_better=0.5)
    text = "\n".join(words_of(replace(VERDICTS["cause"], gain=(better, worse, known))))
    assert "1 of 2 channels is predicted better" in text
    assert "payload as known" not in text
    assert "  reflector 1 z: " not in text
    assert "0.405 -> 0.081 of" in gain_text(replace(better, channel="known_earlier_1", unit="1"))


def test_a_channel_that_the_model_does_not_touch_is_predicted_no_worse() -> None:
    """A force sensor with a gain of -1e-12 was one channel worse."""
    better = VERDICTS["cause"].gain[0]
    for gain, word in ((-1e-12, "none worse"), (-0.05, "1 worse")):
        other = replace(NO_GAIN, over_better=gain, over_better_low=2 * gain, over_better_high=gain)
        assert word in gain_sentence(replace(VERDICTS["cause"], gain=(better, other)))


def test_a_climb_is_told_step_by_step() -> None:
    first = VERDICTS["cause"].steps[0]
    steps = (first, replace(first, added=(MASS,), log_evidence=7.0, channels=(NO_GAIN,)))
    lines = list(words_of(replace(VERDICTS["cause"], steps=steps)))
    worth = "  loss of gas: +94, held out +81 (60 to 103); without it -> with it"
    assert f"{worth}: motor current 2 0.612 -> 0.081 A" in lines
    one = replace(first, of_recording="may")
    lines_of_one = list(words_of(replace(VERDICTS["cause"], steps=(one, steps[1]))))
    assert f"{worth}, in recording may: motor current 2 0.612 -> 0.081 A" in lines_of_one
    assert any("without it -> with it, all else fitted both times" in line for line in lines)
    assert "  mass of a link (upper arm): +7, held out +81 (60 to 103)" in lines


def test_what_may_be_a_part_of_the_unlisted_cause_is_said_to_be() -> None:
    lines = list(words_of(VERDICTS["a part of the unlisted one"]))
    assert "     50 %  zero of a joint (joint 2)" in lines
    assert any("or it is a part of what is unlisted" in line for line in lines)


def test_a_set_is_not_guessed_between() -> None:
    text = "\n".join(words_of(VERDICTS["set"]))
    assert "either loss of gas or gas warmer or colder, which these data cannot tell apart" in text
    assert "     50 %  or gas warmer or colder" in text
    assert (
        "It would decide between loss of gas and gas warmer or colder: it is expected to add 24.2 to the logarithm of "
        "their Bayes factor, which is 0.3 with the data at hand."
    ) in text


def test_columns_of_a_proposal_are_called_as_people_call_them() -> None:
    drift = Proposal("a sweep", ("drift (tau_motor_1_n)", "delay of the motor encoders"), 11.4, 7.1)
    assert "between drift (motor force 1) and delay of the motor encoders" in proposal_text(drift)
    alone = replace(drift, splits=("none of it", "drift (tau_motor_1_n)"))
    assert proposal_text(alone).startswith("It would decide whether there is drift (motor force 1): it is expected")


def test_causes_without_a_balance_are_called_as_people_call_them() -> None:
    keys = ("stribeck joint 2", "gas_step robot from run line on", "backlash")
    words = list(words_of(replace(NOTHING, not_simulated=keys)))
    assert words[-3:] == [
        f"Not looked for: {cause}, whose model found no balance."
        for cause in ("Stribeck effect (joint 2)", "gas lost or filled in (from run line on)", "backlash")
    ]


def test_nothing_found_says_what_would_have_been() -> None:
    text = "\n".join(words_of(VERDICTS["nothing"]))
    assert "chance would still find something in 1 % of such campaigns" in text
    assert "zero of a joint, joint 2: offset 0.012 deg" in text
    assert "transmission error of the gear, joint 2: sin 0.0018 to 0.0054 deg, by its shape" in text
    assert "18391" not in text
    assert "Not detectable at a plausible size: length of a link (upper arm): length; Stribeck effect" in text
    blind = replace(VERDICTS["nothing"], blind=(UndetectableEffect("link_length", ("upper_arm",), ()),))
    assert "Not detectable at a plausible size: Stribeck effect (joints 1, 2): rise of some shapes." in words_of(blind)


def test_slow_motion_that_would_show_an_effect_is_said() -> None:
    slow = UndetectableEffect("stribeck", ("joint 1",), (), below=(0.019,), shape="speed", unit="m/s")
    blind = (UndetectableEffect("stribeck", ("joint 2", "joint 3"), ()), slow)
    (line,) = (one for one in words_of(replace(VERDICTS["nothing"], blind=blind)) if "Not to be seen" in one)
    assert line == (
        "Not to be seen here; sweeps of these joints at several slow steady speeds would show: Stribeck effect "
        "(joints 2, 3), Stribeck effect (joint 1) of a speed below 0.0190 m/s."
    )


def test_a_remainder_without_a_shape_is_said() -> None:
    lines = list(words_of(VERDICTS["a remainder"]))
    assert not any("unlisted" in line for line in lines)
    assert any(line.startswith("Something is left that is too small to give a shape") for line in lines)


def test_nothing_found_in_a_channel_that_is_all_noise_is_not_praised() -> None:
    noisy = (NoisyChannel("current_6_a", True, 174.0), *(NoisyChannel(f"current_{i}_a", False, 4.0) for i in (1, 2, 3)))
    lines = list(words_of(replace(NOTHING, noise_scale=31.0, noisy=noisy)))
    assert lines[0] == "Nothing found, but motor current 6 scatters 174 times as much as its instrument."
    (scatter,) = (line for line in lines if line.startswith("The data scatter"))
    assert "motor current 6 in motion by 174 times its instrument's error, motor current 1 at rest by 4" in scatter
    assert "and 1 more" in scatter


def test_a_scatter_that_rounds_to_that_of_the_instruments_is_none() -> None:
    assert not any("scatter" in line for line in words_of(replace(NOTHING, noise_scale=1.0002)))
    assert not any("scatter" in line for line in words_of(replace(NOTHING, noise_scale=float("nan"))))
    assert any("1.12 times as large" in line for line in words_of(replace(NOTHING, noise_scale=1.12)))


def test_a_scatter_that_widens_no_interval_as_it_is_shown_is_none() -> None:
    """Each channel counts with 1 at least, so 1.02 is chance: the page said that data scatter more than instruments."""
    assert not any("scatter" in line for line in words_of(replace(NOTHING, noise_scale=1.02)))
    noisy = NoisyChannel("current_2_a", in_motion=True, times=9.0)  # one of many
    assert any("1.02 times" in line for line in words_of(replace(NOTHING, noise_scale=1.02, noisy=(noisy,))))


def test_probability_that_a_finding_leaves_is_told() -> None:
    """A finding of 37 % stood there without a word on the other 63."""
    best = replace(VERDICTS["cause"].explanations[0], fitted_probability=0.37)
    unsure = replace(VERDICTS["cause"], explanations=(best,), rivals=())
    assert any(line.startswith("The remaining 63 %: the nominal model, and") for line in words_of(unsure))
    sure = replace(unsure, explanations=(replace(best, fitted_probability=0.999),))
    assert not any("remaining" in line for line in words_of(sure))


def test_single_finding_that_is_not_confirmed_says_why() -> None:
    step = replace(VERDICTS["cause"].steps[0], repeats=0.2)
    lines = list(words_of(replace(VERDICTS["cause"], steps=(step,))))
    assert "Not confirmed: only 20 % of the searches without a part of the runs find it." in lines


def test_what_is_ruled_out_and_what_a_step_mends_is_no_wall_of_text() -> None:
    cause = VERDICTS["cause"]
    rival, step = cause.explanations[0], cause.steps[0]
    names = [replace(WARM, place=f"joint {i}") for i in range(1, 7)]
    verdict = replace(cause, rivals=tuple(replace(rival, causes=(name,)) for name in names))
    (line,) = [line for line in words_of(verdict) if line.startswith("Fitted, and ruled out")]
    assert "joint 3" in line
    assert line.endswith("; 3 more (rivals in verdict.json).")
    gains = tuple(replace(step.channels[0], channel=f"current_{i}_a", gain=i / 10, low=0.01) for i in range(1, 6))
    text = step_text(replace(step, channels=gains, log_evidence=4778366.7))
    assert "+4 778 367," in text
    assert "with it: motor current 5 " in text
    assert text.endswith(", 3 more")


def test_steps_that_an_unlisted_shape_replaced_are_not_told_as_kept() -> None:
    steps = (VERDICTS["cause"].steps[0],) * 2
    lines = list(words_of(replace(VERDICTS["unlisted"], steps=steps)))
    assert "No cause of these steps is kept: what is unlisted explains more than they do." in lines
    assert not any(line.startswith("No cause of these") for line in words_of(replace(VERDICTS["cause"], steps=steps)))


def test_files_are_named(tmp_path: Path) -> None:
    assert not any(line.startswith("robot ") for line in places_of(tmp_path))
    (tmp_path / "robot").mkdir()
    assert any(str(tmp_path / "robot") in line for line in places_of(tmp_path))


def in_two(accepted: bool, *nats: float) -> Step:
    recordings = tuple(RecordingGain(name, gain) for name, gain in zip("AB", nats, strict=True))
    low = min(nats)
    return Step((ZERO,), 20.0, sum(nats), low, max(nats), accepted, "held out", recordings=recordings)


def test_a_finding_of_the_machine_says_which_recordings_confirm_it() -> None:
    assert step_text(in_two(True, 12.0, 5.0)).endswith("confirmed by 2 of 2 recordings (A +12, B +5)")
    assert in_two(True, 12.0, -1.0).confirmed_by == ("A",)
    # "only 0 % of the searches without one recording find it; confirmed by 2 of 2" said two things that are not one
    assert step_text(replace(in_two(True, 12.0, 5.0), repeats=0.0)).endswith(
        "; to be found it takes all recordings together (without one of them 0 % of searches find it); "
        "confirmed by 2 of 2 recordings (A +12, B +5)"
    )
    alone = in_two(True, float("nan"), float("nan"))
    assert confirmed_text(alone) == "confirmed by 0 of 2 recordings: one alone shows it"


def test_what_does_not_repeat_is_withdrawn() -> None:
    words = refused_text(in_two(False, -19.0, 11.0))
    assert words == (
        "Withdrawn: zero of a joint (joint 2): it does not repeat from recording to recording, "
        "confirmed by 1 of 2 recordings (A -19, B +11)."
    )
    assert (
        refused_text(Step((ZERO,), 20.0, 1.0, -1.0, 2.0, False, "why.")) == "Refused: zero of a joint (joint 2): why."
    )


def test_a_finding_that_hangs_on_a_few_runs_is_not_confirmed() -> None:
    """A cause stood there with 98 %, and far below that none of the searches without a part of the runs found it."""
    verdict = VERDICTS["cause"]
    (group, *others) = verdict.findings
    name = cause_name(group.names[0].cause)
    for is_confirmed in (True, False):
        told = replace(verdict, findings=(replace(group, is_confirmed=is_confirmed), *others))
        line = next(line for line in words_of(told) if f"%  {name}" in line)
        assert line.endswith("not confirmed") is not is_confirmed


@pytest.mark.parametrize(
    ("by", "how"),
    [("recording", "each recording predicted by"), ("run", "each run predicted by"), ("block", "by the farther half")],
)
def test_promises_say_what_they_rest_on(by: str, how: str) -> None:
    (line,) = (words for words in words_of(replace(NOTHING, held_out_by=by)) if "what it promises" in words)
    assert how in line


def test_the_floor_is_no_bound() -> None:
    """Held-out errors below it were puzzling where it was called what noise would leave of a perfect model."""
    text = "\n".join(words_of(VERDICTS["cause"]))
    assert "the floor is the error to be expected of a right model" in text
    assert "it is no bound" in text


def test_a_robot_that_lacks_what_is_unlisted_is_said_to_have_other_sizes() -> None:
    """Coulomb friction of 2.20 Nm in the verdict was 3.10 Nm in the robot, and no word said so."""
    words = "The robot that is handed over lacks what is unlisted, an error of the readings of tracker"
    beside = VERDICTS["unlisted beside a listed one"]
    assert beside.unlisted
    for runs in (False, True):
        text = "\n".join(words_of(replace(beside, unlisted=replace(beside.unlisted, runs=runs))))
        assert (words in text) != runs


def test_what_stands_in_for_something_unlisted_is_said() -> None:
    alone, beside = VERDICTS["unlisted"], VERDICTS["unlisted beside a listed one"]
    words = "In its place the robot that is handed over has loss of gas: not all that acts there"
    for verdict in (alone, beside):
        assert verdict.unlisted
        assert words not in "\n".join(words_of(verdict))
        with_one = replace(verdict, unlisted=replace(verdict.unlisted, stand_ins=(GAS,)))
        text = "\n".join(words_of(with_one))
        assert words in text
        assert "The robot that is handed over lacks what is unlisted" in text
