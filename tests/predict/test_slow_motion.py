"""What of a drive's motion is compared is said: a stranger's axis erred nineteen times as much where it went slowly."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.slow_motion import SlowMotion, slow_motion
from bench.predict.prediction import Prediction
from bench.report.diagnosis.slow import slow_sentence
from bench.report.prediction.words import words_of


def compared(linear: LinearisedModel, segments: tuple[Segment, ...]) -> SlowMotion:
    (found,) = slow_motion(segments, linear.quantities, linear.replay.compiled.is_slide)
    return found


def test_bins_that_are_not_read_are_not_compared(prediction: Prediction) -> None:
    """Of sweeps at constant speed nearly all is compared; without the readings of the slower ones half of the bins."""
    (recording,) = prediction.recordings
    linear = recording.linear
    whole = compared(linear, linear.segments)
    assert not slow_sentence((whole,))
    assert not any("Slow motion" in line for line in words_of(prediction))
    drive = next(c for c, quantity in enumerate(linear.quantities) if quantity.column == whole.channel)
    joint = linear.quantities[drive].index
    moving = [one for one in linear.segments if one.path and not one.standing[joint]]
    speeds = np.concatenate([np.abs(one.motion.velocity[one.motion.read, joint]) for one in moving])
    middle = float(np.median(speeds))

    def without_slow(segment: Segment) -> Segment:
        observed = segment.observed.copy()
        observed[np.abs(segment.motion.velocity[segment.motion.read, joint]) < middle, drive] = np.nan
        return replace(segment, observed=observed)

    half = compared(linear, tuple(without_slow(one) if one.path else one for one in linear.segments))
    assert half.slowest == pytest.approx(middle, rel=0.05)
    assert half.slowest > 1.5 * whole.slowest
    assert 0.2 * whole.share < half.share < 0.8 * whole.share
    assert f"{100 * half.share:.0f} % of the time, from " in slow_sentence((half,))
