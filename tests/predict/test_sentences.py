"""A prediction in sentences: what is named of many broken promises, and what to do about them."""

from dataclasses import replace

import pytest

from bench.predict.predict import predict
from bench.predict.prediction import Prediction
from bench.record.campaign import Campaign
from bench.report.prediction.sentences import broken_sentence, headline
from bench.robot.compiled import CompiledRobot


def promised(campaign: Campaign, nominal: CompiledRobot, highs: list[float]) -> Prediction:
    """Return a prediction with as many channels as there are upper ends of promised intervals, all with an RMS of 1."""
    found = predict(campaign, nominal, nominal)
    (recording,) = found.recordings
    channel = replace(recording.channels[0], rms=1.0, low=0.01)
    channels = [replace(channel, channel=f"tau_motor_{j}_nm", high=high) for j, high in enumerate(highs, start=1)]
    return replace(found, recordings=(replace(recording, channels=tuple(channels)),))


@pytest.mark.parametrize(
    ("highs", "words"),
    [
        ([0.5, 0.2, 2.0], "; motor torque 2 and motor torque 1 have larger errors than promised."),
        (
            [0.5, 0.1, 0.4, 0.2, 2.0],
            "; 4 errors are larger than promised, above all those of motor torque 2, motor torque 4 and motor "
            "torque 3.",
        ),
    ],
)
def test_the_worst_broken_promises_are_named(
    campaign: Campaign, nominal: CompiledRobot, highs: list[float], words: str
) -> None:
    assert headline(promised(campaign, nominal, highs)).endswith(words)


def test_a_broken_promise_comes_with_what_to_do(campaign: Campaign, nominal: CompiledRobot) -> None:
    assert "bench diagnose CAMPAIGN --given MODEL" in broken_sentence(promised(campaign, nominal, [0.5]))
    assert broken_sentence(promised(campaign, nominal, [2.0])) == ""
