"""Single rows that no drive can have made: angles that jump, currents far beyond its torque limit."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.resolution import step_of
from bench.effects.places import most_acceleration, most_speed, most_torque, torque_limit
from bench.record.campaign import Array, Campaign, Run
from bench.record.channels import columns_of
from bench.record.finding import Finding, Level, spell_rows
from bench.record.rules.sheet import TRAVEL
from bench.robot.compiled import CompiledRobot

STEADY = 99.0  # declared: per cent of the readings that a limit has to hold for; single ones are something else
SPOILT = "lost or spoilt? leave such rows out"
LOST = "rows that were lost, and a clock that was made even? give each row the time that it was read at"
BEYOND = 2.0  # declared: times the limit of a drive, as far as a guess of it may be off; servos peak by less


def jumps(campaign: Campaign, compiled: CompiledRobot) -> Iterator[Finding]:
    """Yield a doubt for each angle that jumps from one row to the next, faster than its drive can go.

    Either it is back in the row after, or it goes on from there, as where rows are lost and the clock was made even.

    Args:
        campaign: A checked campaign.
        compiled: Its robot, nominal.
    """
    for run in campaign.of_kind("motion"):
        told: set[int] = set()  # rows of this run; what jumps in all columns is told once
        for column in columns_of(run.columns, "q_motor", "q_link"):
            step, time = np.diff(run.columns[column.name]), np.diff(run.columns["time_s"])
            coarse = step_of(run.columns[column.name])  # an encoder goes on by one of its steps more, or fewer
            fastest = BEYOND * most_speed(compiled, column.index - 1)
            sharpest = BEYOND * most_acceleration(compiled, column.index - 1)
            is_jump = np.abs(step) - coarse > np.maximum(fastest * time, TRAVEL[column.unit])
            back = np.pad(is_jump[:-1] & is_jump[1:] & (step[:-1] * step[1:] < 0), 1)[: len(run)]
            there_and_back = f"no drive goes there and back so fast ({fastest:.3g} per s)"
            yield from _told("doubt", run, column.name, back, there_and_back, SPOILT)

            onward = np.append(False, _is_onward(step, time, coarse, TRAVEL[column.unit], fastest, sharpest))
            if rows := set(np.flatnonzero(onward).tolist()) - told:
                told |= rows
                size = float(np.max(np.abs(step[onward[1:]])))
                why = f"{size:.3g} {column.unit} from the row before, and goes on from there; no drive goes so fast"
                yield from _told("doubt", run, column.name, onward, why, LOST)


def _is_onward(
    step: Array, time: Array, coarse: float, travel: float, fastest: float, sharpest: float
) -> NDArray[np.bool_]:
    """Return which steps of an angle no drive can make between the speeds before and after them, shape (T - 1,).

    Of two speeds below v at both ends of a time t, an acceleration a leads no farther than v t + a t^2/4.

    Args:
        step: From row to row, shape (T - 1,).
        time: The same way.
        coarse: Step of the encoder.
        travel: Of steps that noise makes.
        fastest: Speed of its drive at most.
        sharpest: Its acceleration at most.
    """
    speed = np.pad(np.abs(step) / time, 1)
    beside = np.maximum(speed[:-2], speed[2:])
    farthest = np.minimum(fastest * time, beside * time + sharpest * time**2 / 4)
    is_jump = np.abs(step) - coarse > np.maximum(farthest, travel)
    # of a joint that is too fast for longer the angle has another unit, which is told elsewhere
    return np.zeros_like(is_jump) if np.any(is_jump[:-1] & is_jump[1:]) else is_jump


def overloads(campaign: Campaign, compiled: CompiledRobot) -> Iterator[Finding]:
    """Yield a warning for each drive's channel that is far beyond its torque limit in single rows, and within it else.

    Args:
        campaign: A checked campaign.
        compiled: Its robot, nominal.
    """
    for run in campaign.runs:
        for column in columns_of(run.columns, "current", "tau_motor"):
            per_unit = compiled.torque_constant[column.index - 1] if column.channel.quantity == "current" else 1.0
            limit = most_torque(compiled, column.index - 1) / abs(per_unit)
            size = np.abs(run.columns[column.name])
            far = size > BEYOND * limit
            if np.all(size[~far] <= limit):  # what goes on from within to beyond has another unit, or another limit
                yield from _told("warning", run, column.name, far, f"the limit of its drive is {limit:.3g}", SPOILT)


def beyond_guessed_limits(campaign: Campaign, compiled: CompiledRobot) -> Iterator[Finding]:
    """Yield a warning for each drive that paid more than a guess of its torque limit may be off.

    Args:
        campaign: A checked campaign.
        compiled: Its robot, nominal.
    """
    worst: dict[str, tuple[float, float]] = {}  # column -> largest reading, and the limit
    for run in campaign.runs:
        for column in columns_of(run.columns, "current", "tau_motor"):
            j = column.index - 1
            if compiled.robot.figures.assumes("torque limit", compiled.robot.figures.drives[j].joint):
                per_unit = compiled.torque_constant[j] if column.channel.quantity == "current" else 1.0
                most = float(np.nanpercentile(np.abs(run.columns[column.name]), STEADY))
                if most > most_torque(compiled, j) / abs(per_unit):
                    limit = torque_limit(compiled, j) / abs(per_unit)
                    worst[column.name] = max(worst.get(column.name, (0.0, limit)), (most, limit))
    for name, (most, limit) in worst.items():
        message = f"reads up to {most:.3g}, and the torque limit that was assumed for its drive is {limit:.3g}"
        remedy = "state it, and make the folder anew: rotor, stiffness and largest payload were guessed by it"
        yield Finding("warning", "all runs", None, name, message, remedy)


def _told(
    level: Level, run: Run, column: str, is_beyond: NDArray[np.bool_], why: str, remedy: str
) -> Iterator[Finding]:
    rows = (np.flatnonzero(is_beyond) + 1).tolist()
    if rows and len(rows) < len(run):
        value = run.columns[column][rows[0] - 1]
        message = f"reads {value:.6g} in {spell_rows(rows)} of run {run.name!r}; {why}"
        yield Finding(level, "all runs", None, column, message, remedy)
