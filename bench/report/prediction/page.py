"""The report of a prediction as one self-contained HTML page."""

from collections.abc import Sequence
from dataclasses import dataclass

from bench.predict.prediction import PredictedRecording, Prediction
from bench.report.diagnosis.facts import versions
from bench.report.diagnosis.names import capital
from bench.report.diagnosis.pictures import Picture
from bench.report.diagnosis.sentences import FLOOR
from bench.report.diagnosis.slow import slow_sentence
from bench.report.html import render
from bench.report.prediction.pictures import pictures_of
from bench.report.prediction.sentences import (
    ChannelRow,
    anew_sentence,
    anew_text,
    broken_sentence,
    exact_sentence,
    free_sentence,
    freed_text,
    headline,
    promise_sentence,
    rows_of,
    stretch_text,
    untold_sentence,
)

TEMPLATE = "prediction/page.html.j2"


@dataclass(frozen=True)
class _Part:
    """One recording as the page shows it."""

    name: str
    rows: tuple[ChannelRow, ...]
    slow: str
    freed: tuple[str, ...]
    untold: str
    exact: str
    anew: tuple[str, ...]
    anew_words: str
    stretches: tuple[str, ...]
    pictures: tuple[tuple[str, Picture], ...]


def page_of(prediction: Prediction, made: Sequence[str], command: str = "") -> str:
    """Return the page.

    Args:
        prediction: What it says.
        made: Files that stand beside it.
        command: That made it; "" if none did.
    """
    return render(
        TEMPLATE,
        {"capital": capital},
        prediction=prediction,
        headline=headline(prediction),
        floor_words=FLOOR,
        promise_words=promise_sentence(prediction),
        broken_words=broken_sentence(prediction),
        free_words=free_sentence(prediction),
        parts=[_part(recording) for recording in prediction.recordings],
        command=command,
        files=made,
        versions=versions(),
    )


def _part(recording: PredictedRecording) -> _Part:
    return _Part(
        name=recording.name,
        rows=tuple(rows_of(recording)),
        slow=slow_sentence(recording.slow),
        freed=tuple(freed_text(figure) for figure in recording.freed),
        untold=untold_sentence(recording),
        exact=exact_sentence(recording),
        anew=tuple(anew_text(one, recording) for one in recording.maybe_anew),
        anew_words=anew_sentence(recording),
        stretches=tuple(stretch_text(stretch, recording) for stretch in recording.stretches),
        pictures=pictures_of(recording),
    )
