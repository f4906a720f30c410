"""Torques that are read late are those of the motion some time before, however suddenly they change."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from bench.diagnose.replay.courses import count_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Acting, Place
from bench.effects.recorded import recorded_in
from bench.record.campaign import Campaign
from tests.diagnose.sweeps import LOADS, SWEEPS, made, nominal

DRIVE = "current_2_a"
DELAYS = {name: catalogue()[name] for name in ("channel_delay", "drive_delay")}


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


def replay_of(campaign: Campaign) -> tuple[Replay, Place]:
    """Return a campaign, ready to be repeated, and the drive whose current is to be late."""
    compiled, quantities = nominal(), quantities_of(campaign.runs, nominal())
    recorded = recorded_in(campaign.runs, compiled.model.opt.gravity)
    (place,) = (one for one in DELAYS["channel_delay"].places_in(compiled, recorded) if one.name == DRIVE)
    return Replay(compiled, segments_of(campaign, compiled, quantities), quantities), place


def late(seconds: float, place: Place = WHOLE) -> Acting:
    """Return a delay of one drive, or of all of them."""
    return Acting(DELAYS["drive_delay" if place == WHOLE else "channel_delay"], place, {"delay": seconds})


@pytest.mark.parametrize("seconds", [0.005, -0.012, 0.0033])
def test_a_late_torque_is_that_of_the_motion_before(seconds: float) -> None:
    campaign = made(SWEEPS, seed=3)
    here, place = replay_of(campaign)
    there, *_ = replay_of(moved_before(campaign, seconds))
    column = [quantity.column for quantity in here.quantities].index(DRIVE)
    changed = here.predict(World(acting=(late(seconds, place),))) - here.predict(NOMINAL)
    others = np.arange(len(here.quantities)) != column
    assert not np.any(changed[:, others])
    wanted = (there.predict(NOMINAL) - here.predict(NOMINAL))[:, column]
    assert np.sqrt(np.mean((changed[:, column] - wanted) ** 2)) < 0.05 * np.sqrt(np.mean(wanted**2))


def test_all_drives_are_late_together_and_one_besides() -> None:
    replay, drive = replay_of(made(SWEEPS, seed=3))
    one = [quantity.column for quantity in replay.quantities].index(DRIVE)
    worlds = (late(0.008),), (late(0.008, drive),), (late(0.005), late(0.003, drive))
    together, alone, both = (replay.predict(World(acting=acting)) for acting in worlds)
    np.testing.assert_array_equal(together[:, one], alone[:, one])
    np.testing.assert_array_equal(both[:, one], alone[:, one])
    changed = np.any(together != replay.predict(NOMINAL), axis=0)
    assert [quantity.is_drive for quantity in replay.quantities] == changed.tolist()


def test_a_late_torque_at_rest_is_the_same() -> None:
    sweeps, loads = made(SWEEPS, seed=3), made(LOADS, seed=3)
    replay, place = replay_of(replace(sweeps, runs=(*sweeps.runs, *loads.runs)))
    at_rest = np.concatenate([np.full(count_of(segment), segment.is_static) for segment in replay.segments])
    assert 0 < np.sum(at_rest) < len(at_rest)
    changed = replay.predict(World(acting=(late(0.2, place),))) - replay.predict(NOMINAL)
    assert not np.any(changed[at_rest])
    assert np.any(changed[~at_rest])
