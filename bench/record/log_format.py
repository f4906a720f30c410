"""How a laboratory's own log reads: which of its columns becomes which column of a campaign, and by what factor.

One YAML file, `log.yaml` in the robot's folder; `bench.record.convert` applies it.
"""

from pathlib import Path
from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from bench.errors import InputError, unknown_name
from bench.record.campaign import RunKind
from bench.record.channels import NOISY, known_names, parse_column
from bench.record.units import right_name
from bench.record.yaml_text import YamlFault, load_yaml

LOG_FORMAT = "log.yaml"


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Origin(_Strict):
    """Where a column of a campaign comes from: value = factor * logged + offset, in the unit of the column's name."""

    source: str = Field(alias="from", min_length=1, description="name of the column in the log, as written there")
    factor: float = Field(1.0, description="unit, gear ratio, drive gain and sign in one")
    offset: float = Field(0.0, description="added after the factor")
    optional: bool = Field(False, description="logs without it are converted too, without the column")


class LogFormat(_Strict):
    """What stands in a `log.yaml`.

    Attributes:
        kind: Of the runs that logs of this kind become.
        columns: Column name of a campaign -> where it comes from.
        noise: Quantity -> standard deviation of one reading, as in a campaign.
        notes: Free words that go into the campaign.
    """

    kind: RunKind = "motion"
    columns: dict[str, Origin] = Field(min_length=1)
    noise: dict[str, Annotated[float, Field(gt=0)]] = {}
    notes: str = ""

    @model_validator(mode="after")
    def _names_are_known(self) -> Self:
        problems = []
        for name in self.columns:
            if parse_column(name) is None:
                right = right_name(name)
                hint = f"write {right[0]!r} and put the factor of the unit there" if right else ""
                problems.append(f"columns: {name}: {hint or unknown_name('column', name, known_names(name))}")
        problems += [f"noise: {unknown_name('quantity', q, NOISY)}" for q in self.noise if q not in NOISY]
        if problems:
            raise ValueError("; ".join(problems))
        return self


def read_log_format(path: Path) -> LogFormat:
    """Read a `log.yaml`.

    Raises:
        InputError: It cannot be read or breaks the schema; every fault is listed with its place.
    """
    try:
        return LogFormat.model_validate(load_yaml(path))
    except YamlFault as fault:
        raise InputError(f"{path}: {fault}; {fault.remedy}") from fault
    except ValidationError as error:
        faults = []
        for detail in error.errors():
            place = ".".join(str(part) for part in detail["loc"]) or "top level"
            faults.append(f"{path}: {place}: {detail['msg'].removeprefix('Value error, ')}")
        raise InputError(faults) from error
