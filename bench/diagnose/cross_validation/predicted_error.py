"""What a model promises of a recording that nobody has made yet."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class PredictedError:
    """What a model will leave of one channel in a recording that nobody has made yet.

    Attributes:
        channel: Column of the campaign.
        unit: SI.
        kind: Of recording.
        runs: Runs it rests on.
        rms: Plain root mean square over the held-out readings of all these runs.
        low, high: 90 % prediction interval of the root mean square of one more recording, set up anew; nan where
            runs are too few to tell how far they differ.
        fitted_low, fitted_high: The same of a recording to which what is set up anew is fitted; nan as well.
    """

    channel: str
    unit: str
    kind: Literal["static", "motion"]
    runs: int
    rms: float
    low: float
    high: float
    fitted_low: float = float("nan")
    fitted_high: float = float("nan")
