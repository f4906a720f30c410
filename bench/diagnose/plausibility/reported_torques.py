"""Torques that drives report besides their currents: a diagnosis takes the currents, but somebody will believe both."""

from collections.abc import Iterator

import numpy as np

from bench.effects.places import torque_limit
from bench.record.campaign import Campaign
from bench.record.finding import Finding
from bench.robot.compiled import CompiledRobot

NOTHING = 0.01  # assumed: of a drive's torque limit; what noise and an offset of a standing drive may read


def unlike_currents(campaign: Campaign, compiled: CompiledRobot) -> Iterator[Finding]:
    """Yield a warning for each drive whose reported torque is another than its current makes.

    Args:
        campaign: A checked campaign.
        compiled: Its robot, nominal.
    """
    for j in range(compiled.n_joints):
        column = f"tau_motor_{j + 1}_{'n' if compiled.is_slide[j] else 'nm'}"
        current = f"current_{j + 1}_a"
        runs = [run for run in campaign.runs if column in run.columns and current in run.columns]
        if not runs:
            continue
        reported = np.concatenate([run.columns[column] for run in runs])
        made = compiled.torque_constant[j] * np.concatenate([run.columns[current] for run in runs])
        least = max(float(np.sqrt(np.mean(made**2))), NOTHING * torque_limit(compiled, j))
        left = float(np.sqrt(np.mean((reported - made) ** 2)))
        if left > least:  # a column of zeros is no farther away; torque constants and friction explain a third
            message = f"is {left:.3g} (rms) away from what {current} makes by the torque constant"
            remedy = f"look at its unit and sign; it is not used, {current} is"
            yield Finding("warning", "all runs", None, column, message, remedy)
