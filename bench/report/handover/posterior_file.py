"""What a diagnosis knew of figures and findings, in the robot folder that it hands over: `posterior.json`."""

import json
import os
from dataclasses import asdict
from hashlib import blake2b
from pathlib import Path
from typing import Literal

import numpy as np
from pydantic import Field, ValidationError

from bench.diagnose.replay.given import Posterior, PosteriorParameter
from bench.errors import RobotError
from bench.record.json_text import DIGEST_BYTES, expect_sealed, load_json, sealed
from bench.record.limits import MODEL_BYTES, YAML_BYTES
from bench.record.plain_file import FileFault, read_plain
from bench.record.strict import Strict
from bench.robot.folder import FIGURES_FILE, load_robot, problems_of

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
    before: float = 0.0


class _Content(Strict):
    format: Literal[1]
    robot: str
    parameters: tuple[_Parameter, ...]
    covariance: tuple[tuple[float, ...], ...]
    seal: str


def write_posterior(folder: Path, posterior: Posterior) -> None:
    """Write what a diagnosis knew into the robot folder that it handed over, which is complete but for it."""
    content = {
        "format": 1,
        "robot": _digest_of_robot(folder),
        "parameters": [asdict(one) for one in posterior.parameters],
        "covariance": posterior.covariance.tolist(),
    }
    (folder / POSTERIOR).write_text(json.dumps(sealed(content)) + "\n", encoding="utf-8")


def read_posterior(folder: Path) -> Posterior:
    """Return what the diagnosis knew that handed a robot over.

    Raises:
        RobotError: There is no such file, it is not what `write_posterior` wrote, or the robot is another one since.
    """
    path = folder / POSTERIOR
    if not os.path.lexists(path):
        raise RobotError(f"{path}: does not exist; give the folder that a finished `bench diagnose` wrote.")
    try:
        read = load_json(path)
        content = _Content.model_validate(read)
        expect_sealed(read)
    except ValueError as error:  # JSON, UTF-8 and pydantic alike
        faults = problems_of(error, POSTERIOR) if isinstance(error, ValidationError) else [f"{POSTERIOR}: {error}"]
        raise RobotError([*faults, f"{path}: restore it, or diagnose again."]) from error
    n = len(content.parameters)
    if len(content.covariance) != n or any(len(row) != n for row in content.covariance):
        raise RobotError(f"{path}: covariance: needs {n} rows of {n} numbers, one for each parameter.")
    covariance = np.array(content.covariance, dtype=np.float64).reshape(n, n)
    if n and not np.all(np.linalg.eigvalsh((covariance + covariance.T) / 2) > 0):
        raise RobotError(f"{path}: covariance: is none, for it is not positive definite; diagnose again.")
    if content.robot != _digest_of_robot(folder):
        raise RobotError(
            f"{folder}: the robot was changed after its diagnosis, which knew it as it was; restore it, or take it as "
            "it is with --robot."
        )
    return Posterior(tuple(PosteriorParameter(**one.model_dump()) for one in content.parameters), covariance)


def _digest_of_robot(folder: Path) -> str:
    """Return the digest of a robot's MJCF and figures; meshes and files that are included are not looked at.

    Raises:
        RobotError: The folder holds no robot, or files that are none.
    """
    robot, state = load_robot(folder), blake2b(digest_size=DIGEST_BYTES)
    for file, most in ((robot.mjcf, MODEL_BYTES), (robot.folder / FIGURES_FILE, YAML_BYTES)):
        try:
            state.update(blake2b(read_plain(file, most)).digest())
        except FileFault as fault:
            raise RobotError(f"{file}: {fault}; {fault.remedy}.") from fault
    return state.hexdigest()
