"""A campaign in which one motion lacks a channel that the others have."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.segments import segments_of
from bench.hide.campaign import hide_campaign
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.simulate.rotation_small import small_rotation

GAUGE = "gas_pressure_pa"
BINS = 120


def test_a_run_without_a_gauge_counts_beside_runs_with_one(small_robot: Path) -> None:
    """A gauge shows whole digits; looking for those of a run that has none ended in a KeyError."""
    compiled = compile_robot(load_robot(small_robot))
    campaign = hide_campaign(compiled.robot, small_rotation(small_robot), (), np.random.default_rng(1)).campaign
    first, *others = campaign.runs
    columns = {name: values for name, values in first.columns.items() if name != GAUGE}
    poorer = replace(campaign, runs=(replace(first, columns=columns), *others))
    quantities = quantities_of(poorer.runs, compiled)
    gauge = [quantity.column for quantity in quantities].index(GAUGE)
    segments = segments_of(poorer, compiled, quantities, BINS)
    seen = {segment.run: bool(np.any(np.isfinite(segment.observed[:, gauge]))) for segment in segments}
    assert seen == {run.name: run.name != first.name for run in campaign.runs}
