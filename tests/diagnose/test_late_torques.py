"""Torques that are read late are those of the motion some time before, however suddenly they change."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.effects.recorded import recorded_in
from bench.record.campaign import Campaign
from tests.diagnose.sweeps import SWEEPS, made, nominal

DRIVE = "current_2_a"


def moved_before(campaign: Campaign, seconds: float) -> Campaign:
    """Return a campaign whose motors were everywhere some time later."""
    runs = []
    for run in campaign.runs:
        time = run.columns["time_s"]
        when = np.clip(time - seconds, time[0], time[-1])
        columns = {
            name: CubicSpline(time, values)(when) if name.startswith("q_motor") else values
            for name, values in run.columns.items()
        }
        runs.append(replace(run, columns=columns))
    return replace(campaign, runs=tuple(runs))


@pytest.mark.parametrize("seconds", [0.005, -0.012])
def test_a_late_torque_is_that_of_the_motion_before(seconds: float) -> None:
    compiled, campaign = nominal(), made(SWEEPS, seed=3)
    effect = catalogue()["channel_delay"]
    (place,) = (
        one
        for one in effect.places_in(compiled, recorded_in(campaign.runs, compiled.model.opt.gravity))
        if one.name == DRIVE
    )
    quantities = quantities_of(campaign.runs, compiled)
    column = [quantity.column for quantity in quantities].index(DRIVE)
    here = Replay(compiled, segments_of(campaign, compiled, quantities), quantities)
    late = World(acting=(Acting(effect, place, {"delay": seconds}),))
    there = Replay(compiled, segments_of(moved_before(campaign, seconds), compiled, quantities), quantities)
    changed = here.predict(late) - here.predict(NOMINAL)
    others = np.arange(len(quantities)) != column
    assert not np.any(changed[:, others])
    expected = there.predict(NOMINAL)
    assert expected.shape == changed.shape
    wanted = (expected - here.predict(NOMINAL))[:, column]
    assert np.sqrt(np.mean((changed[:, column] - wanted) ** 2)) < 0.05 * np.sqrt(np.mean(wanted**2))
