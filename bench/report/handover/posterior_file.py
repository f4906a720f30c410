"""What a diagnosis knew of figures and findings, in the robot folder that it hands over: `posterior.json`."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field, ValidationError

from bench.diagnose.replay.given import Posterior, PosteriorParameter
from bench.errors import RobotError
from bench.record.json_text import load_json
from bench.robot.folder import problems_of
from bench.robot.strict import Strict

POSTERIOR = "posterior.json"


class _Parameter(Strict):
    name: str
    unit: str
    sigma: float = Field(gt=0)
    found: float
    effect: str
    place: str
    parameter: str
    shapes: dict[str, float]


class _Content(Strict):
    format: Literal[1]
    parameters: tuple[_Parameter, ...]
    covariance: tuple[tuple[float, ...], ...]


def write_posterior(folder: Path, posterior: Posterior) -> None:
    """Write what a diagnosis knew into the robot folder that it handed over."""
    content = {
        "format": 1,
        "parameters": [asdict(one) for one in posterior.parameters],
        "covariance": posterior.covariance.tolist(),
    }
    (folder / POSTERIOR).write_text(json.dumps(content) + "\n", encoding="utf-8")


def read_posterior(folder: Path) -> Posterior:
    """Return what the diagnosis knew that handed a robot over.

    Raises:
        RobotError: There is no such file, or it is not what `write_posterior` writes.
    """
    path = folder / POSTERIOR
    if not path.is_file():
        raise RobotError(f"{path}: does not exist; give the folder that a finished `bench diagnose` wrote.")
    try:
        content = _Content.model_validate(load_json(path))
    except ValueError as error:  # JSON, UTF-8 and pydantic alike
        raise RobotError(
            problems_of(error, POSTERIOR) if isinstance(error, ValidationError) else f"{path}: {error}"
        ) from error
    n = len(content.parameters)
    if len(content.covariance) != n or any(len(row) != n for row in content.covariance):
        raise RobotError(f"{path}: covariance: needs {n} rows of {n} numbers, one for each parameter.")
    covariance = np.array(content.covariance, dtype=np.float64).reshape(n, n)
    if n and not np.all(np.linalg.eigvalsh((covariance + covariance.T) / 2) > 0):
        raise RobotError(f"{path}: covariance: is none, for it is not positive definite; diagnose again.")
    return Posterior(tuple(PosteriorParameter(**one.model_dump()) for one in content.parameters), covariance)
