"""Work over a closed path: friction takes energy out, gravity, gas and inertia give back what they took."""

from collections.abc import Iterator

import numpy as np

from bench.record.finding import Finding
from bench.record.rules.sheet import Sheet

# Of the travel. Where a path ends this near to its beginning, conservative work cancels to 1 % of all work exchanged.
CLOSED = 0.02
# Of all work exchanged. A delay of 5 ms between torque and angle at 0.5 rad/s, or noise of the current, makes 0.2 % of
# either sign. Friction takes 31 to 99 % on the six axes of a KUKA KR300 in motion, 88 % on a ball screw (EMPS).
GAINED = 0.05


def friction_takes(sheet: Sheet) -> Iterator[Finding]:
    """Each joint that moves alone, there and back, takes work from its motor. If it gives work, a sign is wrong."""
    if sheet.run.kind != "motion":
        return
    moving = {column.index for column, _ in sheet.columns("q_cmd", "q_motor") if sheet.moves(column.name)}
    joint = sheet.joint(min(moving), "q_motor") if len(moving) == 1 else None
    if joint is None:
        return
    column, angle = joint
    if abs(angle[-1] - angle[0]) > CLOSED * np.ptp(angle):
        return
    for effort, values in sheet.columns("current", "tau_motor"):
        if effort.index == column.index:
            work = (values[1:] + values[:-1]) / 2 * np.diff(angle)
            if work.sum() < -GAINED * np.abs(work).sum():
                message = f"gives the motor energy while {column.name} goes there and back"
                yield sheet.doubt(effort.name, message, "turn the sign of one of them")
