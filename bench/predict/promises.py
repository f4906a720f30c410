"""What a diagnosis promises of the next recording, kept in the robot folder that it hands over."""

import json
import os
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path
from typing import Literal, Self

import numpy as np
from pydantic import ValidationError, model_validator

from bench.diagnose.cross_validation.predicted_error import PredictedError
from bench.errors import RobotError
from bench.record.json_text import expect_sealed, load_json, sealed
from bench.record.strict import Strict
from bench.robot.folder import problems_of

PROMISES = "promises.json"
ENDS = ("low", "high", "fitted_low", "fitted_high")


class _Promise(Strict):
    channel: str
    unit: str
    kind: Literal["static", "motion"]
    runs: int
    rms: float
    low: float | None
    high: float | None
    fitted_low: float | None = None
    fitted_high: float | None = None

    @model_validator(mode="after")
    def _ends_in_order(self) -> Self:
        for low, high in ((self.low, self.high), (self.fitted_low, self.fitted_high)):
            if low is not None and high is not None and low > high:
                raise ValueError(f"the low end, {low:g}, is above the high one, {high:g}")
        return self


class _Promises(Strict):
    format: Literal[1]
    promises: tuple[_Promise, ...]
    seal: str


def write_promises(folder: Path, promises: Iterable[PredictedError]) -> None:
    """Write what is promised of the next recording into a robot folder.

    Args:
        folder: Of the robot.
        promises: For each channel at rest and in motion; nan ends, where nothing can be promised, are written as null.
    """
    entries = [asdict(promise) for promise in promises]
    for entry in entries:
        entry |= {end: entry[end] if np.isfinite(entry[end]) else None for end in ENDS}
    text = json.dumps(sealed({"format": 1, "promises": entries}), indent=2)
    (folder / PROMISES).write_text(text + "\n", encoding="utf-8")


def read_promises(folder: Path) -> tuple[PredictedError, ...]:
    """Return what a robot folder promises; nothing where no diagnosis wrote it.

    Raises:
        RobotError: The file is not what `write_promises` wrote.
    """
    path = folder / PROMISES
    if not os.path.lexists(path):
        return ()
    try:
        read = load_json(path)
        content = _Promises.model_validate(read)
        expect_sealed(read)
    except ValueError as error:  # JSON, UTF-8 and pydantic alike
        faults = problems_of(error, PROMISES) if isinstance(error, ValidationError) else [f"{PROMISES}: {error}"]
        raise RobotError([*faults, f"{path}: restore it, or remove it: then nothing is promised."]) from error
    return tuple(
        PredictedError(
            channel=one.channel,
            unit=one.unit,
            kind=one.kind,
            runs=one.runs,
            rms=one.rms,
            **{end: np.nan if (value := getattr(one, end)) is None else value for end in ENDS},
        )
        for one in content.promises
    )
