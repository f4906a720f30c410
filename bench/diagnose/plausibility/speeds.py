"""How fast joints went by a recording's own clock."""

import numpy as np

from bench.effects.places import speed_limit
from bench.record.campaign import Campaign, Run
from bench.record.channels import columns_of
from bench.robot.compiled import CompiledRobot

PARTS = 20  # assumed: of a run; no noise, resolution or slow update of an encoder looks like a speed over so long


def least_top_speed(run: Run, number: int) -> float:
    """Return a speed that a joint surely reached: the largest mean one over a `PARTS`-th of a run."""
    columns = columns_of(run.columns, "q_motor", "q_cmd")
    angles = next((run.columns[column.name] for column in columns if column.index == number), None)
    span = len(run) // PARTS
    if angles is None or span == 0:
        return 0.0
    time = run.columns["time_s"]
    return float(np.max(np.abs(angles[span:] - angles[:-span]) / (time[span:] - time[:-span])))


def fastest(campaign: Campaign, compiled: CompiledRobot) -> float:
    """Return the largest speed of any joint, as a part of its drive's limit; 0 where nothing moves."""
    runs = tuple(campaign.of_kind("motion"))
    speeds = (least_top_speed(run, j + 1) / speed_limit(compiled, j) for j in range(compiled.n_joints) for run in runs)
    return max(speeds, default=0.0)
