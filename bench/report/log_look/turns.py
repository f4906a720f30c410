"""Angles without a unit, in range in radians but for whole turns of some: held against torques beside degrees."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from bench.identify.drive_scale import drive_scale
from bench.record.campaign import Array
from bench.record.look.families import Family
from bench.record.turns import as_offset, in_words
from bench.report.log_look.lines import Line
from bench.report.log_look.slow import slow_motion
from bench.robot.nominal_dynamics import NominalDynamics

HALF = 0.5  # of what is unexplained: radians or degrees are taken where less than that is left (assumed)
EXPLAINED = 0.5  # share of the readings, mean over drives, from which they tell that (assumed)


def by_turns(
    lines: Sequence[Line],
    readings: Sequence[Family],
    time: Array,
    columns: Mapping[str, Array],
    nominal: NominalDynamics,
    questions: list[str],
) -> list[Line]:
    """Return angles without a unit in radians, without whole turns, where that explains torques far better.

    Where torques do not tell whether they are in radians or in degrees, that is asked, and they stay as they are.
    """
    on = [line for line in lines if line.turns]
    if not on:
        return list(lines)
    counted = [
        line if line.turns is None else replace(line, factor=1.0, unit="rad", why=in_rad(line)).counted(line.turns)
        for line in lines
    ]
    left = _unexplained(counted, readings, time, columns, nominal)
    given = _unexplained(lines, readings, time, columns, nominal)
    if left < min(HALF * given, 1 - EXPLAINED):
        return counted
    if not given < HALF * left:
        which = ", ".join(f"{line.source} (offset {as_offset(line.turns or 0):.10g})" for line in on)
        questions.append(
            f"radians with {in_words(on[0].turns or 0)}? all angles are in range in radians but for whole turns of "
            f"{which}; this log does not tell: look at the unit of the angles"
        )
    return list(lines)


def in_rad(line: Line) -> str:
    """Return the reason of a line that is in radians after all."""
    before, _, _ = line.why.rpartition("reaches ")
    return f"{before}taken as rad" if before else line.why


def _unexplained(
    lines: Sequence[Line],
    readings: Sequence[Family],
    time: Array,
    columns: Mapping[str, Array],
    nominal: NominalDynamics,
) -> float:
    """Return the share of readings that the model leaves along angles, mean over drives, of the best family; else 1."""
    slow = slow_motion(lines, readings, time, columns, nominal.n_joints)
    if slow is None:
        return 1.0
    shares = [
        drive_scale(nominal, slow.time, slow.position, reading, counts=slow.moves[sources]).explained
        for sources, reading in slow.readings.items()
    ]
    return min((1 - float(np.nanmean(share)) for share in shares), default=1.0)
