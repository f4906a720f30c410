"""The files of a prediction: prediction.json, report.html, and a Rerun recording of every recording."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from bench.errors import NoLibraryError
from bench.predict.prediction import MaybeAnew, PredictedRecording, Prediction
from bench.report.jsonable import to_jsonable
from bench.report.prediction.file_names import NUMBERS, REPORT, recording_name
from bench.report.prediction.page import page_of
from bench.report.prediction.recording import write_prediction_recording


def write_prediction(prediction: Prediction, folder: Path, command: str = "") -> tuple[str, ...]:
    """Write the files of a prediction into an existing folder.

    Args:
        prediction: What to write.
        folder: Where to.
        command: That made it, for the page.

    Returns:
        What to print of it: a sentence where there is no recording because Rerun's library cannot be loaded.

    Raises:
        InputError: A recording cannot be written.
        RobotError: The scene that the robot's figures name does not compile.
    """
    text = json.dumps(to_jsonable(json_of(prediction) | {"command": command}), indent=2)
    (folder / NUMBERS).write_text(text + "\n", encoding="utf-8")
    names = []
    missing: dict[str, None] = {}
    for i, recording in enumerate(prediction.recordings):
        name = recording_name(i + 1, len(prediction.recordings))
        try:
            write_prediction_recording(folder / name, recording)
            names.append(name)
        except NoLibraryError as error:  # the numbers are worth having without it
            missing[str(error)] = None
    (folder / REPORT).write_text(page_of(prediction, [NUMBERS, *names], command), encoding="utf-8")
    return tuple(missing)


def json_of(prediction: Prediction) -> dict[str, Any]:
    """Return the content of `prediction.json`; nan and arrays as they are."""
    return {
        "format": 1,
        "model": prediction.model,
        "nominal": prediction.nominal,
        "free": prediction.free,
        "carried_kg": prediction.carried_kg,
        "as_in_recording": prediction.as_in,
        "promised": len(prediction.answers),
        "kept": prediction.answers.count("kept"),
        "broken": prediction.is_broken,
        "recordings": [_recording(recording) for recording in prediction.recordings],
    }


def _recording(recording: PredictedRecording) -> dict[str, Any]:
    return {
        "name": recording.name,
        "channels": [asdict(channel) | {"answer": channel.answer} for channel in recording.channels],
        "stretches": [_without_instants(asdict(stretch)) for stretch in recording.stretches],
        "maybe_anew": [_by_channel(one, recording) for one in recording.maybe_anew],
        "not_told": recording.untold,
        "freed": [asdict(figure) | {"total": figure.total} for figure in recording.freed],
    }


def _by_channel(one: MaybeAnew, recording: PredictedRecording) -> dict[str, Any]:
    """Return what may be anew with what is left of each channel without and with it, in the recording's order."""
    left = [
        {"channel": channel.channel, "kind": channel.kind, "before": before, "rms": rms}
        for channel, before, rms in zip(recording.channels, one.before, one.rms, strict=True)
    ]
    return {"free": one.name, "beside": one.beside, "log_evidence": one.log_evidence, "channels": left}


def _without_instants(stretch: dict[str, Any]) -> dict[str, Any]:
    """Return a stretch without indices that count nothing in the file."""
    return {key: value for key, value in stretch.items() if key not in ("first", "last")}
