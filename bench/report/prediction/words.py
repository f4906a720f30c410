"""A prediction in words for the terminal."""

from collections.abc import Iterator
from pathlib import Path

from bench.predict.prediction import PredictedRecording, Prediction
from bench.report.diagnosis.sentences import FLOOR
from bench.report.diagnosis.slow import slow_sentence
from bench.report.prediction.file_names import NUMBERS, REPORT, recording_name
from bench.report.prediction.sentences import (
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

WORST = 3  # stretches that are named


def words_of(prediction: Prediction) -> Iterator[str]:
    """Yield the lines of a prediction for the terminal."""
    yield headline(prediction)
    if words := promise_sentence(prediction):
        yield words
    if words := broken_sentence(prediction):
        yield words
    yield free_sentence(prediction)
    yield f"The floor is {FLOOR}."
    for recording in prediction.recordings:
        if recording.name:
            yield f"Recording {recording.name}:"
        yield from _table(recording, prediction.nominal)
        if words := slow_sentence(recording.slow):
            yield f"  {words}"
        for figure in recording.freed:
            yield f"  anew: {freed_text(figure)}"
        if words := untold_sentence(recording):
            yield f"  {words}"
        if words := exact_sentence(recording):
            yield f"  {words}"
        if words := anew_sentence(recording):
            yield f"  {words}"
        for one in recording.maybe_anew:
            yield f"  may be anew: {anew_text(one, recording)}"
        for stretch in recording.stretches[:WORST]:
            yield f"  worst: {stretch_text(stretch, recording)}"


def _table(recording: PredictedRecording, nominal: str) -> Iterator[str]:
    heads = ("root mean square", "error", "unit", "promised (90 %)", "", nominal, "floor")
    rows = [(r.name, r.rms, r.unit, r.promised, r.answer, r.nominal, r.floor) for r in rows_of(recording)]
    widths = [max(len(row[i]) for row in (heads, *rows)) for i in range(len(heads))]
    for row in (heads, *rows):
        cells = [
            cell.ljust(width) if i in (0, 2, 4) else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        yield f"  {'  '.join(cells)}".rstrip()


def places_of(folder: Path, prediction: Prediction) -> Iterator[str]:
    """Yield where the files are and how to open them."""
    yield f"report     {folder / REPORT}"
    for i in range(len(prediction.recordings)):
        name = recording_name(i + 1, len(prediction.recordings))
        if (folder / name).is_file():
            yield f"recording  {folder / name}   (bench view {folder})"
    yield f"numbers    {folder / NUMBERS}"
