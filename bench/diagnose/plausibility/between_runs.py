"""What joints would have to do between two runs: begin where the run before left them, or have had time to go there."""

from collections.abc import Iterator
from itertools import pairwise

from bench.effects.places import most_speed
from bench.record.campaign import Array, Campaign, Run
from bench.record.channels import columns_of
from bench.record.finding import Finding
from bench.robot.compiled import CompiledRobot

# declared: [s], steps in which people and programs write down when a run began
STEPS_S = (60.0, 10.0, 1.0, 0.1, 0.01, 0.001)
EXACT = 1e-6  # rounding: of a multiple of a step


def too_far_apart(campaign: Campaign, compiled: CompiledRobot) -> Iterator[Finding]:
    """Yield a warning where joints cannot go from the end of a run to the start of the next one in the time between.

    Times are taken for as fine as the coarsest step of which all `start_s` of a recording are multiples. Runs that
    overlap are told elsewhere (`bench.record.rules.session`).

    Args:
        campaign: A checked campaign.
        compiled: Its robot, nominal.
    """
    timed = [run for run in campaign.runs if "time_s" in run.columns and len(run)]
    for recording in dict.fromkeys(run.recording for run in timed):
        runs = sorted((run for run in timed if run.recording == recording), key=lambda run: run.start_s)
        rounded = _coarsest([run.start_s for run in runs])
        for before, after in pairwise(runs):
            pause = after.start_s - before.start_s - float(before.columns["time_s"][-1])
            if pause < 0:
                continue
            begun, left = _angles(after, 0), _angles(before, -1)
            for j in sorted(begun.keys() & left.keys()):
                needs = abs(begun[j] - left[j]) / most_speed(compiled, j)
                if needs > pause + rounded:
                    drive = compiled.robot.figures.drives[j].joint
                    message = (
                        f"of run {after.name!r} is {pause:.3g} s after the end of {before.name!r}, from where {drive} "
                        f"needs {needs:.3g} s at its top speed"
                    )
                    remedy = "start_s of two runs exchanged, or not in seconds? else the runs are of two recordings"
                    yield Finding("warning", "all runs", None, "start_s", message, remedy)
                    return


def _angles(run: Run, row: int) -> dict[int, float]:
    """Return index of a drive -> its position [rad], [m] in a row, measured or else commanded."""
    found: dict[int, Array] = {}
    for kind in ("q_cmd", "q_motor"):
        found |= {column.index - 1: run.columns[column.name] for column in columns_of(run.columns, kind)}
    return {j: float(values[row]) for j, values in found.items()}


def _coarsest(starts: list[float]) -> float:
    """Return the coarsest step [s] of which all starts are multiples, or the finest."""
    shared = (step for step in STEPS_S if all(abs(start - step * round(start / step)) < EXACT for start in starts))
    return next(shared, STEPS_S[-1])
