"""Loads that were written down wrong, of one run or for as long as a load stayed on."""

from bench.effects.effect import Parameter, Place, Values
from bench.effects.recorded import LogError, Recorded, RecordedRun
from bench.effects.recording_places import OfCampaign
from bench.robot.compiled import CompiledRobot


class _WrittenDown(OfCampaign):
    family = "recording"
    level = "run"
    advice = "weigh what was on the robot in this run, and look at the lab's log"
    source = "range: 5 % up to twice, a figure that slipped (50 for 100, 161 for 116); assumed"

    def places_in(self, compiled: CompiledRobot, recorded: Recorded) -> tuple[Place, ...]:
        """Return each run with such a load, and each time that a load stayed on for several runs."""
        loads = [self.load_in(run) for run in recorded.runs]
        alone = [(run,) for run, load in zip(recorded.runs, loads, strict=True) if load]
        together = [runs for runs in recorded.mountings(loads) if len(runs) > 1]
        return tuple(_place(runs) for runs in (*alone, *together))

    def load_in(self, run: RecordedRun) -> float:
        """Return what tells such loads apart; 0 where none was written down of a run."""
        raise NotImplementedError


def _place(runs: tuple[RecordedRun, ...]) -> Place:
    first, last = runs[0].name, runs[-1].name
    return Place("run", name=first if first == last else f"{first} to {last}", runs=tuple(run.name for run in runs))


class HungLoad(_WrittenDown):
    """Another weight hung on than was written down."""

    name = "hung_load"
    title = "load at the hook"
    physics = (
        "Somebody hung on another weight than the log says, or wrote down another figure: the true force "
        "and moment at the load point are (1 + x) of the written ones."
    )
    parameters = (Parameter("change", "", 0.0, 0.05, 1.0, "x, truth beyond what is written", signed=True, least=-1.0),)

    def load_in(self, run: RecordedRun) -> float:
        """Return 1 where anything hung by what was written down of a run, else 0."""
        return float(run.hangs)

    def log_error(self, place: Place, values: Values, run: str) -> LogError | None:
        return LogError(hung=1 + values["change"]) if run in place.runs and values["change"] else None


class BoltedLoad(_WrittenDown):
    """Another mass was bolted on than was written down."""

    name = "bolted_load"
    title = "mass bolted on"
    physics = (
        "Another mass was bolted to the arm than the log says, or another figure was written down: the "
        "true mass is (1 + x) of the written one."
    )
    parameters = (Parameter("change", "", 0.0, 0.05, 1.0, "x, truth beyond what is written", signed=True, least=-1.0),)

    def load_in(self, run: RecordedRun) -> float:
        """Return the mass that was bolted on by what was written down of a run [kg]."""
        return run.payload_kg

    def log_error(self, place: Place, values: Values, run: str) -> LogError | None:
        return LogError(bolted=1 + values["change"]) if run in place.runs and values["change"] else None
