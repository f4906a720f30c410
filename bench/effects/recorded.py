"""What was recorded in a campaign, and errors that people and clocks make in it, as plain data.

Where an error of the recording may sit follows from what was recorded: from the columns and the runs of a campaign,
never from its readings. All campaigns of one session have equal answers here, so they have the same candidates.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bench.record.campaign import Run
from bench.record.moving import TRAVELS

# assumed: of the longest pause between runs; shorter ones are ways from run to run, without a hand on anything
BREAK = 0.1
# assumed: [s], of a drive's channel, which has the clock of the encoders: five cycles of 4 ms on the bus
LATEST_DRIVE_S = 0.02
LEAST_LOAD = 0.1  # rounding: [N] or [Nm]; less is what rounding leaves of a written weight: 10 g
LateField = Literal["reflectors", "motor_torque", "gas_force"]


@dataclass(frozen=True)
class RecordedRun:
    """One run of a campaign.

    Attributes:
        name: Unique in its campaign.
        start_s, end_s: When it begins and ends, from the start of the campaign [s].
        columns: Names of its columns.
        is_static: Whether every row is a reading at rest.
        hangs: Whether a load hung at the load point by what was written down.
        payload_kg: Mass bolted to it by what was written down.
        moving: Indices of the drives that moved; at rest none.
        recording: Name of the recording that it belongs to, whose clock it has.
    """

    name: str
    start_s: float
    end_s: float
    columns: frozenset[str]
    is_static: bool
    hangs: bool
    payload_kg: float
    moving: frozenset[int] = frozenset()
    recording: str = ""


@dataclass(frozen=True)
class Recorded:
    """The runs of a campaign, in the order in which they were made."""

    runs: tuple[RecordedRun, ...]

    @cached_property
    def recordings(self) -> Mapping[str, "Recorded"]:
        """Name of each recording -> its runs, in order."""
        names = dict.fromkeys(run.recording for run in self.runs)
        return {name: Recorded(tuple(run for run in self.runs if run.recording == name)) for name in names}

    @cached_property
    def columns(self) -> frozenset[str]:
        """Names of all columns."""
        return frozenset(name for run in self.runs for name in run.columns)

    @cached_property
    def after_breaks(self) -> tuple[RecordedRun, ...]:
        """Runs before which somebody may have laid hands on robot or instruments, or an hour may have passed."""
        pauses = np.array([after.start_s - before.end_s for before, after in pairwise(self.runs)])
        if not len(pauses):
            return ()
        long = pauses >= BREAK * np.max(pauses)
        return tuple(run for run, is_long in zip(self.runs[1:], long, strict=True) if is_long)

    def setting_in(self, shows: Callable[[RecordedRun], bool]) -> tuple[RecordedRun, ...]:
        """Return the runs with which something may set in that only some runs show.

        Of breaks between two runs that show it nobody can say after which it set in; they count as one.

        Args:
            shows: Whether a run shows it.
        """
        breaks = {run.name for run in self.after_breaks}
        found = []
        is_known, had_break = False, False
        for run in self.runs:
            had_break |= run.name in breaks
            if shows(run):
                found += [run] if is_known and had_break else []
                is_known, had_break = True, False
        return tuple(found)

    def mountings(self, loads: Sequence[float]) -> tuple[tuple[RecordedRun, ...], ...]:
        """Return runs that follow each other without a break and under one load, those without load left out.

        Args:
            loads: What tells loads apart, one for each run; 0: none.
        """
        breaks = {run.name for run in self.after_breaks}
        found: list[list[RecordedRun]] = []
        last = 0.0
        for run, load in zip(self.runs, loads, strict=True):
            if load and (load != last or run.name in breaks):
                found.append([])
            if load:
                found[-1].append(run)
            last = load
        return tuple(tuple(runs) for runs in found)


NOTHING_RECORDED = Recorded(())


def recorded_in(runs: Iterable[Run], gravity: NDArray[np.float64]) -> Recorded:
    """Return what was recorded in the runs of a campaign.

    Args:
        runs: In the order in which they were made.
        gravity: Shape (3,) [m/s^2].
    """
    return Recorded(
        tuple(
            RecordedRun(
                run.name,
                run.start_s,
                run.start_s + (float(np.max(run.columns["time_s"])) if "time_s" in run.columns else 0.0),
                frozenset(run.columns),
                is_static=run.kind == "static",
                hangs=_hangs(run, gravity),
                payload_kg=float(np.mean(run.columns.get("load_mass_kg", 0.0))),
                moving=_moving(run),
                recording=run.recording,
            )
            for run in runs
        )
    )


def _moving(run: Run) -> frozenset[int]:
    """Return the indices of the drives that moved in a run, by command or else by encoder."""
    if run.kind == "static":
        return frozenset()
    travels: dict[int, float] = {}
    for quantity in ("q_motor", "q_cmd"):
        for name, values in run.columns.items():
            if name.startswith(f"{quantity}_"):
                travels[int(name.split("_")[2]) - 1] = float(np.ptp(values))
    return frozenset(j for j, travel in travels.items() if travel > TRAVELS)


def _hangs(run: Run, gravity: NDArray[np.float64]) -> bool:
    """Whether the written wrench at the load point is more than the weight of what is bolted to it."""
    wrench = np.array(run.load_wrench())
    if "load_mass_kg" in run.columns:
        wrench[:, :3] -= run.columns["load_mass_kg"][:, None] * gravity
    return bool(np.max(np.abs(wrench), initial=0.0) > LEAST_LOAD)


@dataclass(frozen=True)
class LogError:
    """How the truth of a run differs from what was written down of it.

    Attributes:
        hung: True wrench at the load point over the written one.
        bolted: True mass bolted to it over the written one.
    """

    hung: float = 1.0
    bolted: float = 1.0

    def with_another(self, other: "LogError") -> "LogError":
        """Return both errors together."""
        return LogError(self.hung * other.hung, self.bolted * other.bolted)


@dataclass(frozen=True)
class Lateness:
    """A quantity of which the recording shows an older value than the time stamp of its row says.

    Attributes:
        field: Of a `Trace`.
        drive: Index of the only column that is late; None: all of them.
        seconds: By how much [s].
    """

    field: LateField
    drive: int | None
    seconds: float
