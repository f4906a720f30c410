"""What the simulation knows and the instruments do not: hidden effects, true parameters, readings without noise.

Truth stands in a folder of its own, never inside a campaign. Only code that scores an estimate or a verdict may open
it; `bench.identify` and `bench.diagnose` never import this module, and a test holds them to it.
"""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from bench.errors import CampaignError, InputError
from bench.record.campaign import Array, Run
from bench.record.folder import new_folder
from bench.record.manifest import MANIFEST, RUN_NAME
from bench.record.strict import read_as
from bench.record.table import FORMATS, read_table
from bench.record.yaml_text import dump_yaml

TRUTH = "truth.yaml"


@dataclass(frozen=True)
class TrueValue:
    """A parameter as the simulation used it, in `unit`."""

    value: float
    unit: str


@dataclass(frozen=True)
class Truth:
    """What was simulated.

    Attributes:
        parameters: Name -> true value with its unit.
        effects: Names of the effects that were hidden in the data; empty for null data.
        runs: Run name -> column name -> shape (n_rows,), the readings of ideal instruments. Names as in the campaign;
            quantities that no instrument reads may be there too.
    """

    parameters: Mapping[str, TrueValue] = field(default_factory=dict)
    effects: tuple[str, ...] = ()
    runs: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)


def expect_apart(folder: Path) -> None:
    """Refuse a folder to which no truth can be written.

    Raises:
        InputError: It is in a campaign.
    """
    real = Path(os.path.realpath(folder))  # survives a loop of links
    for place in (real, *real.parents):
        if os.path.exists(place / MANIFEST):  # noqa: PTH110  a name may be too long for pathlib
            raise InputError(f"{folder}: {place} is a campaign, and truth is kept apart; choose a folder beside it")


def write_truth(truth: Truth, folder: Path, *, replace: bool = False) -> None:
    """Write truth to a folder, `truth.yaml` and one table per run; the folder appears complete or not at all.

    Args:
        truth: What to write.
        folder: Where; must not exist or be empty, and must not be in a campaign.
        replace: Whether a truth that stands there already may be replaced.

    Raises:
        InputError: The folder is in use, or in a campaign.
    """
    expect_apart(folder)
    parameters = {name: {"value": float(true.value), "unit": true.unit} for name, true in truth.parameters.items()}
    content = {"format": 1, "effects": list(truth.effects), "parameters": parameters, "runs": list(truth.runs)}
    with new_folder(folder, TRUTH, replace) as partial:
        (partial / TRUTH).write_text(dump_yaml(content), encoding="utf-8")
        (partial / "runs").mkdir()
        for name, columns in truth.runs.items():
            FORMATS[".csv"].write(partial / _file(name), columns)


def read_truth(folder: Path) -> Truth:
    """Read what `write_truth` wrote. For scoring only.

    Raises:
        CampaignError: The folder holds no truth, or a damaged one.
    """
    content = read_as(_File, folder / TRUTH, CampaignError)
    tables = {name: read_table(folder, _file(name)) for name in content.runs}
    if faults := [f"{folder}/{finding}" for table in tables.values() for finding in table.findings]:
        raise CampaignError(faults)
    parameters = {name: TrueValue(value.value, value.unit) for name, value in content.parameters.items()}
    runs = {name: Run(name, "motion", 0.0, table.columns).columns for name, table in tables.items()}
    return Truth(parameters, content.effects, runs)


def _file(name: str) -> str:
    return f"runs/{name}.csv"


class _Value(BaseModel):
    model_config = ConfigDict(extra="forbid")

    value: float
    unit: str = ""


class _File(BaseModel):
    model_config = ConfigDict(extra="forbid")

    format: Literal["1"]
    effects: tuple[str, ...] = ()
    parameters: dict[str, _Value] = {}
    runs: tuple[Annotated[str, Field(pattern=RUN_NAME)], ...] = ()
