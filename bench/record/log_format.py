"""How a laboratory's own log reads: which of its columns becomes which column of a campaign, and by what factor.

One YAML file, `log.yaml` in the robot's folder; `bench.record.convert` applies it.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Self

from pydantic import Field, field_validator, model_validator

from bench.errors import InputError, unknown_name
from bench.record.campaign import RunKind
from bench.record.channels import NOISY, known_names, parse_column
from bench.record.logs.cuts import Cuts
from bench.record.logs.dialect import PLAIN, Dialect
from bench.record.logs.resample import Fill, Resampling
from bench.record.possible import noise_faults
from bench.record.strict import Strict, read_as
from bench.record.units import right_name

LOG_FORMAT = "log.yaml"
LONGEST_NUMBER = 6  # digits of the number of a column; tables have a thousand columns at most


class Origin(Strict):
    """Where a column of a campaign comes from: value = factor * logged + offset, in the unit of the column's name."""

    source: str = Field("", alias="from", description="name of the column in the log, or else its number from 1")
    table: str = Field("", description="name of one of `tables` that it stands in; by default the log itself")
    rate_hz: float | None = Field(None, gt=0, description="of `time_s` in a log without a clock: samples per second")
    fill: Fill | None = Field(None, description="what empty cells stand for: hold: the last reading; line: between two")
    factor: float = Field(1.0, description="unit, gear ratio, drive gain and sign in one")
    offset: float = Field(0.0, description="added after the factor")
    optional: bool = Field(False, description="logs without it are converted too, without the column")

    @field_validator("factor")
    @classmethod
    def _keeps_what_is_logged(cls, factor: float) -> float:
        if factor == 0:
            raise ValueError(
                "is 0, which makes one number of all that is logged; write what one unit of the log is here"
            )
        return factor

    @model_validator(mode="after")
    def _comes_from_somewhere(self) -> Self:
        if (self.source == "") == (self.rate_hz is None):
            raise ValueError("write `from:` with the name or the number of a column (a log without a clock: rate_hz)")
        return self

    def name_in(self, names: Sequence[str]) -> str:
        """Return the name of its column in a table; a name that a table does not have may be a number."""
        if self.source in names or not self._is_number:
            return self.source
        return names[int(self.source) - 1] if 0 < int(self.source) <= len(names) else ""

    @property
    def _is_number(self) -> bool:
        return self.source.isascii() and self.source.isdigit() and len(self.source) < LONGEST_NUMBER

    def __str__(self) -> str:
        """How an error names it."""
        if self.rate_hz is not None:
            return "rate_hz"
        where = f" of {self.table}" if self.table else ""
        return (f"column {self.source}" if self._is_number else self.source) + where


class Beside(Strict):
    """Another table of the same moment with a clock of its own: a file beside the log, or a topic of a recording."""

    file: str = Field("", description="name of the file; * stands for the name of the log without its ending")
    topic: str = Field("", description="of an MCAP recording: the topic")
    time_s: Origin = Field(description="its clock, the same one as that of the log")
    table: Dialect = Field(PLAIN, description="how its text is written")

    @model_validator(mode="after")
    def _stands_somewhere(self) -> Self:
        if bool(self.file) == bool(self.topic):
            raise ValueError("write either file (beside the log) or topic (of an MCAP recording)")
        if self.file and (Path(self.file).name != self.file or self.file == ".."):
            raise ValueError("file stands beside the log: give its name alone, without folders")
        return self


class LogFormat(Strict):
    """What stands in a `log.yaml`.

    Attributes:
        kind: Of the runs that logs of this kind become.
        table: How the text of a log is written.
        topic: Of an MCAP recording, the topic whose messages are the rows; needed where it has several.
        tables: Name -> another table beside each log, with a clock of its own.
        runs: What of a log becomes runs.
        resample: A new clock; None: that of the log.
        columns: Column name of a campaign -> where it comes from.
        noise: Quantity -> standard deviation of one reading, as in a campaign.
        notes: Free words that go into the campaign.
    """

    kind: RunKind = "motion"
    table: Dialect = PLAIN
    topic: str = ""
    tables: dict[str, Beside] = Field({})
    runs: Cuts = Cuts.model_validate({})
    resample: Resampling | None = None
    columns: dict[str, Origin] = Field(min_length=1)
    noise: dict[str, Annotated[float, Field(gt=0)]] = Field({})
    notes: str = ""

    @property
    def reads_drives(self) -> bool:
        """Whether it reads a torque or a current of a drive."""
        return any(name.startswith(("tau_motor_", "current_")) for name in self.columns)

    @model_validator(mode="after")
    def _names_are_known(self) -> Self:
        problems = []
        for name in self.columns:
            if parse_column(name) is None:
                right = right_name(name)
                hint = f"write {right[0]!r} and put the factor of the unit there" if right else ""
                problems.append(f"columns: {name}: {hint or unknown_name('column', name, known_names(name))}")
        for name, origin in self.columns.items():
            if origin.rate_hz is not None and name != "time_s":
                problems.append(f"columns: {name}: rate_hz is for time_s alone")
            if origin.table and origin.table not in self.tables:
                problems.append(f"columns: {name}: {unknown_name('table', origin.table, self.tables)}")
        if "time_s" not in self.columns and not (self.runs.cuts_nothing and self.resample is None and not self.tables):
            problems.append("runs, resample and tables need a clock: write time_s into columns")
        problems += [f"noise: {unknown_name('quantity', q, NOISY)}" for q in self.noise if q not in NOISY]
        problems += [f"noise: {q}: {words}; {remedy}" for q, words, remedy in noise_faults(self.noise, NOISY)]
        if problems:
            raise ValueError("; ".join(problems))
        return self


def read_log_format(path: Path) -> LogFormat:
    """Read a `log.yaml`.

    Raises:
        InputError: It cannot be read or breaks the schema; every fault is listed with its place.
    """
    return read_as(LogFormat, path, InputError, ("columns",))
