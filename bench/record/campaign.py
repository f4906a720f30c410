"""A campaign in memory: what the instruments saw, and nothing else.

Truth (hidden effects, true parameters, noise-free readings) is another type in another file (`bench.record.truth`).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bench.errors import CampaignError
from bench.record.known import Known

Array = NDArray[np.float64]

SHORT = 2000  # rows; in shorter tables a call of NumPy takes longer than what it does

RunKind = Literal["static", "motion"]


@dataclass(frozen=True, eq=False)
class Run:
    """One table of readings.

    Attributes:
        name: Unique in its campaign; also the name of its file.
        kind: "static": every row is one reading at rest, repeats are kept as rows, the columns `pose`, `approach`,
            `load_step` and `repeat` say which. "motion": rows are samples of one continuous movement.
        start_s: Wall-clock time of the run since the start of its recording [s], where its `time_s` is 0.
        columns: Column name -> shape (n_rows,), read-only. Names and units: `bench.record.channels`.
        note: Free words.
        recording: Name of the recording that it belongs to. Between two recordings instruments may have been set up
            anew, another payload bolted on, gas refilled; the machine is the same.

    Raises:
        CampaignError: The columns are not equally long vectors.
    """

    name: str
    kind: RunKind
    start_s: float
    columns: Mapping[str, Array]
    note: str = ""
    recording: str = ""

    def __post_init__(self) -> None:
        columns = {name: _read_only(values) for name, values in self.columns.items()}
        shapes = {name: values.shape for name, values in columns.items()}
        if any(len(shape) != 1 for shape in shapes.values()) or len(set(shapes.values())) > 1:
            raise CampaignError(f"run {self.name!r}: columns must be vectors of one length, not {shapes}")
        object.__setattr__(self, "columns", columns)

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()))) if self.columns else 0

    @cached_property
    def extremes(self) -> Mapping[str, tuple[float, float]]:
        """Column name -> its smallest and largest value; both nan if any is nan. Empty for a run without rows."""
        if not len(self):
            return {}
        every = list(self.columns.values())
        if len(self) < SHORT:
            lowest, highest = (reduce(np.stack(every), axis=1).tolist() for reduce in (np.min, np.max))
        else:
            lowest, highest = ([float(reduce(values)) for values in every] for reduce in (np.min, np.max))
        return dict(zip(self.columns, zip(lowest, highest, strict=True), strict=True))

    def stack(self, quantity: str, unit: str, keys: tuple[str, ...]) -> Array:
        """Return columns `<quantity>_<key>_<unit>` side by side, shape (n_rows, len(keys)); nan where missing."""
        missing = np.full(len(self), np.nan)
        return np.stack([self.columns.get(f"{quantity}_{key}_{unit}", missing) for key in keys], axis=1)

    def load_wrench(self) -> Array:
        """Return the wrench known to act on the load point, shape (n_rows, 6) [N, Nm], world axes.

        A component without a column is zero: nothing was hung that way.
        """
        force = self.stack("load", "n", ("x", "y", "z"))
        moment = self.stack("load", "nm", ("mx", "my", "mz"))
        wrench: Array = np.nan_to_num(np.concatenate([force, moment], axis=1))
        return wrench


@dataclass(frozen=True)
class Campaign:
    """A validated set of runs on one robot.

    Attributes:
        robot: Name of a robot folder, or a path to one.
        runs: Recording after recording, each in wall-clock order; names unique.
        started: When the first recording began, or None if nobody wrote it down.
        noise: Quantity -> standard deviation of one reading in the quantity's SI unit, where the lab knows better than
            the robot's figures. Quantities as in `bench.record.channels`.
        notes: Free words.
        known: What the lab knows besides the tables.
    """

    robot: str
    runs: tuple[Run, ...]
    started: datetime | None = None
    noise: Mapping[str, float] = field(default_factory=dict)
    notes: str = ""
    known: tuple[Known, ...] = ()

    @cached_property
    def recordings(self) -> tuple[str, ...]:
        """Names of the recordings, in order."""
        return tuple(dict.fromkeys(run.recording for run in self.runs))

    def of_kind(self, kind: RunKind) -> Iterator[Run]:
        """Yield the runs of one kind, in order."""
        return (run for run in self.runs if run.kind == kind)


def in_order(runs: Sequence[Run]) -> tuple[Run, ...]:
    """Return runs recording after recording, as these are first named, each in the order of its own clock."""
    recordings = list(dict.fromkeys(run.recording for run in runs))
    return tuple(sorted(runs, key=lambda run: (recordings.index(run.recording), run.start_s)))


@dataclass(frozen=True)
class Arm:
    """What a check needs to know of the robot, in plain numbers.

    Attributes:
        is_slide: One for each drive; a joint that is not a slide is a hinge.
        limits: One (lower, upper) for each drive [rad] or [m]; infinite where the joint has no limit.
        gear_ratios: One for each drive, None where its figures do not state it; or none at all.
        n_reflectors: How many reflectors it carries; None: nobody says.
    """

    is_slide: tuple[bool, ...]
    limits: tuple[tuple[float, float], ...]
    gear_ratios: tuple[float | None, ...] = ()
    n_reflectors: int | None = None

    def __post_init__(self) -> None:
        if len(self.is_slide) != len(self.limits):
            raise CampaignError(f"{len(self.is_slide)} joints cannot have {len(self.limits)} pairs of limits")

    @property
    def n_drives(self) -> int:
        """Number of drives."""
        return len(self.is_slide)


def _read_only(values: object) -> Array:
    array = np.asarray(values, dtype=np.float64)
    if array.flags.writeable:
        array = array.copy()
        array.flags.writeable = False
    return array
