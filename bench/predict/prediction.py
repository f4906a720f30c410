"""What a model leaves of a campaign, recording by recording, and whether what was promised of it holds."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.slow_motion import SlowMotion, slow_motion
from bench.diagnose.replay.world import World
from bench.predict.freed import FreedFigure
from bench.record.campaign import Array

SEEN = 0.1  # declared: of an error in some channel, by which what may be anew has to lower it
Answer = Literal["kept", "less", "more", "not promised"]


@dataclass(frozen=True)
class ChannelError:
    """What a model leaves of one channel of a recording, at rest or in motion; all root mean squares.

    Attributes:
        channel: Column of the campaign.
        unit: SI.
        kind: Of its runs.
        readings: How many were compared: means of repeats, and bins of motion.
        rms: Of measured less predicted.
        nominal: Of measured less what the nominal robot predicts; nan where that finds no balance.
        floor: Expected of a right model (`floor_variance`); chance may leave less.
        measured: Of what was measured (`Quantity.size`).
        low, high: 90 % interval that was promised of `rms`; nan where nothing was.
    """

    channel: str
    unit: str
    kind: Literal["static", "motion"]
    readings: int
    rms: float
    nominal: float
    floor: float
    measured: float
    low: float = float("nan")
    high: float = float("nan")

    @property
    def answer(self) -> Answer:
        """Whether the interval holds, or on which side the error left it."""
        if np.isnan(self.low) or np.isnan(self.high):
            return "not promised"
        if self.rms > self.high:
            return "more"
        return "less" if self.rms < self.low else "kept"


@dataclass(frozen=True)
class Stretch:
    """A visit at rest, or a part of a run in motion, of which a model leaves much.

    Attributes:
        run: Name.
        label: Run, and pose and approach of a visit.
        start_s, end_s: On the clock of the run, as its `time_s` [s].
        first, last: Its first and last instant, of those of the recording.
        channel: Column of the campaign.
        unit: SI.
        rms: Root mean square of measured less predicted.
        floor: The same, expected of a right model there.
    """

    run: str
    label: str
    start_s: float
    end_s: float
    first: int
    last: int
    channel: str
    unit: str
    rms: float
    floor: float


@dataclass(frozen=True)
class MaybeAnew:
    """What would make a recording far more probable if it were fitted to it, by itself or beside others.

    Attributes:
        name: For `--free`.
        log_evidence: Logarithm of how many times more probable [nats].
        before: What the model leaves without, one for each of the recording's `channels`, in their units.
        rms: The same with it.
        beside: What else is free both times, of what may be anew; none: it is fitted by itself.
    """

    name: str
    log_evidence: float
    before: tuple[float, ...]
    rms: tuple[float, ...]
    beside: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class PredictedRecording:
    """A recording and what a model says of it; T instants, c quantities.

    Attributes:
        name: Of the recording; "" if the campaign has one that nobody named.
        linear: It, linearised about the model.
        world: What was fitted anew of it; the model as it stands where nothing was.
        error: Shape (T, c), measured less predicted; nan where not measured.
        nominal_error: Shape (T, c), measured less what the nominal robot predicts.
        noise: Shape (T, c), standard deviation of what no model can predict; nan where not measured.
        freed: What was fitted anew and is told, as differences from what the model has, with intervals.
        is_exact: Whether these intervals take all other figures of the model as exact; else they count how well its
            diagnosis knew them.
        untold: Names of what was fitted anew and the recording does not tell: that it stayed is not said.
        maybe_anew: What else is worth freeing, the likeliest first; several may have one cause.
        channels: Every channel with a reading.
        starts: Name of each run -> when it began, on the clock of the recording [s].
        stretches: The worst stretch of each channel, that which is furthest above what no model can predict first.
    """

    name: str
    linear: LinearisedModel
    world: World
    error: Array
    nominal_error: Array
    noise: Array
    freed: tuple[FreedFigure, ...]
    is_exact: bool
    untold: tuple[str, ...]
    maybe_anew: tuple[MaybeAnew, ...]
    channels: tuple[ChannelError, ...]
    stretches: tuple[Stretch, ...]
    starts: Mapping[str, float]

    @property
    def slow(self) -> tuple[SlowMotion, ...]:
        """How much of the motion of each drive is compared."""
        return slow_motion(self.linear.segments, self.linear.quantities, self.linear.replay.compiled.is_slide)

    @property
    def measured(self) -> Array:
        """Shape (T, c); nan where not measured."""
        return self.linear.observed


@dataclass(frozen=True, eq=False)
class Prediction:
    """A model against a campaign.

    Attributes:
        model: Title of the robot.
        nominal: Name of the robot that it is compared with.
        free: What was allowed to be anew in every recording.
        recordings: At least one.
        carried_kg: Mass of the payload that the model has, beside what a recording states [kg].
        as_in: Of several recordings that the model was made of, the one whose payload and zeros it has; "": of one, or
            none says so.
    """

    model: str
    nominal: str
    free: tuple[str, ...]
    recordings: tuple[PredictedRecording, ...]
    carried_kg: float
    as_in: str

    @property
    def answers(self) -> tuple[Answer, ...]:
        """One for each promised interval and recording."""
        found = (channel.answer for recording in self.recordings for channel in recording.channels)
        return tuple(answer for answer in found if answer != "not promised")

    @property
    def is_broken(self) -> bool:
        """Whether the model left more than it promised anywhere; less than promised harms nobody."""
        return "more" in self.answers
