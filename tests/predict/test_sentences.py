"""A prediction in sentences: what is named of many broken promises, and what to do about them."""

import re
from dataclasses import replace

import numpy as np
import pytest

from bench.predict.freed import FreedFigure
from bench.predict.predict import predict
from bench.predict.prediction import PredictedRecording, Prediction
from bench.record.campaign import Campaign
from bench.report.diagnosis.recording_clock import recording_clock_of
from bench.report.prediction.sentences import broken_sentence, freed_text, headline, promise_sentence, stretch_text
from bench.report.prediction.words import words_of
from bench.robot.compiled import CompiledRobot


def promised(found: Prediction, highs: list[float]) -> Prediction:
    """Return a prediction with as many channels as there are upper ends of promised intervals, all with an RMS of 1."""
    (recording,) = found.recordings
    channel = replace(recording.channels[0], rms=1.0, low=0.01)
    channels = [replace(channel, channel=f"tau_motor_{j}_nm", high=high) for j, high in enumerate(highs, start=1)]
    return replace(found, recordings=(replace(recording, channels=tuple(channels)),))


@pytest.mark.parametrize(
    ("highs", "words"),
    [
        (
            [0.5, 0.2, 2.0],
            "2 of 3 errors are larger than promised: motor torque 2 and motor torque 1 (1 of 3 lie in the promised "
            "intervals, 2 above).",
        ),
        (
            [0.5, 0.1, 0.4, 0.2, 2.0],
            "4 of 5 errors are larger than promised: above all those of motor torque 2, motor torque 4 and motor "
            "torque 3 (1 of 5 lie in the promised intervals, 4 above).",
        ),
    ],
)
def test_the_worst_broken_promises_are_named(prediction: Prediction, highs: list[float], words: str) -> None:
    assert headline(promised(prediction, highs)) == words


def test_a_broken_promise_comes_with_what_to_do(prediction: Prediction) -> None:
    assert "bench diagnose CAMPAIGN --given MODEL" in broken_sentence(promised(prediction, [0.5]))
    assert broken_sentence(promised(prediction, [2.0])) == ""


def test_it_is_said_which_recording_a_model_carries_the_payload_of(
    campaign: Campaign, nominal: CompiledRobot, prediction: Prediction
) -> None:
    """A model of two recordings broke its promise of the first: it had the payload of the second."""
    found = promised(prediction, [0.5])
    assert (found.carried_kg, found.as_in) == (0.0, "")
    assert promise_sentence(found).endswith("It carries nothing, beside what a recording states.")
    words = promise_sentence(replace(found, carried_kg=141.7234, as_in="b"))
    assert "It carries 141.7 kg at the load point" in words
    assert "as in b, the last of the recordings that it was made of" in words
    words = promise_sentence(replace(found, carried_kg=141.7234, as_in="b", free=("payload",)))
    assert words.endswith("what it carries is fitted anew here.")
    assert "carries what the model carries" not in words
    fitted = nominal.robot.figures.fitted.model_copy(update={"recording": "b"})
    figures = nominal.robot.figures.model_copy(update={"fitted": fitted})
    model = replace(nominal, robot=replace(nominal.robot, figures=figures))
    assert predict(campaign, model, nominal).as_in == "b"


def test_errors_below_what_was_promised_are_no_broken_promises(prediction: Prediction) -> None:
    found = promised(prediction, [2.0, 2.0, 2.0])
    (recording,) = found.recordings
    first, *others = recording.channels
    channels = (replace(first, low=1.5), *others)
    assert (
        headline(replace(found, recordings=(replace(recording, channels=channels),)))
        == "No error is larger than promised (2 of 3 lie in the promised intervals, 1 below)."
    )


PAYLOAD = FreedFigure(
    "change of the payload: mass", "finding", "kg", 0.0, 4.946, 4.912, 4.98, np.nan, np.nan, "", np.nan, model=6.952
)
ZERO = FreedFigure(
    "zero of link encoder 2", "figure", "rad", 0.0, -1e-4, -2e-4, 0.0, 2e-3, -0.05, "", np.nan, model=0.0
)


@pytest.mark.parametrize(
    ("figure", "words"),
    [
        (
            PAYLOAD,
            "change of the payload: mass: +4.946 kg (+4.912 to +4.980) relative to the 6.952 kg of the model, so "
            "11.898 kg in all",
        ),
        (
            replace(PAYLOAD, total_low=11.1, total_high=12.7),
            "change of the payload: mass: +4.946 kg (+4.912 to +4.980) relative to the 6.952 kg of the model, so "
            "11.898 kg (11.100 to 12.700) in all",
        ),
        (
            replace(PAYLOAD, model=np.nan),
            "change of the payload: mass: +4.946 kg (+4.912 to +4.980) relative to what the model has",
        ),
        (
            ZERO,
            "zero of link encoder 2: -0.0057 deg (-0.0115 to 0.0000) relative to the 0.0000 deg of the model, so "
            "-0.0057 deg in all; stated within 0.11 deg",
        ),
    ],
)
def test_what_is_fitted_anew_is_a_difference_from_the_model(figure: FreedFigure, words: str) -> None:
    assert freed_text(figure) == words


def test_intervals_of_what_is_fitted_anew_say_on_what_they_rest(
    campaign: Campaign, nominal: CompiledRobot, prediction: Prediction
) -> None:
    lines = list(words_of(predict(campaign, nominal, nominal, free=("encoder_zero",))))
    assert any("takes all other figures of the model as exact" in line for line in lines)
    assert not any("as exact" in line for line in words_of(prediction))


def test_a_stretch_says_where_pictures_of_several_runs_have_it(campaign: Campaign, plain: PredictedRecording) -> None:
    """On the clock of the recording runs begin hours later than the pictures end."""
    clock = recording_clock_of(plain.linear)
    for stretch in plain.stretches:
        told = re.search(
            r"([\d.]+) to ([\d.]+) s of the run, ([\d.]+) to ([\d.]+) s in the pictures",
            stretch_text(stretch, plain),
        )
        assert told
        start, end, first, last = map(float, told.groups())
        duration = next(run for run in campaign.runs if run.name == stretch.run).columns["time_s"][-1]
        assert 0 <= start < end <= duration + 0.1
        assert 0 <= first < last <= clock.seconds[-1] + 0.1
