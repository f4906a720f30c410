"""Visits of a static run: what tells them apart, where a pose is visited again."""

from functools import cache

import numpy as np

from bench.diagnose.linearise.signatures import Signatures
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.segments import Segment, segments_of
from bench.record.campaign import Campaign, Run
from bench.robot.compiled import CompiledRobot
from tests.diagnose.sweeps import nominal

ROWS = 8
TRACKER = tuple(f"reflector_1_{axis}_m" for axis in "xyz")


@cache
def campaign() -> Campaign:
    """Return a campaign of one pose in which the load is put on and taken off again and again, over an hour."""
    step = np.arange(ROWS) % 2
    columns = {
        "time_s": 600.0 * np.arange(ROWS),
        "pose": np.ones(ROWS),
        "load_step": step.astype(float),
        "load_z_n": -1000.0 * step,
        **{f"q_cmd_{i + 1}_rad": np.full(ROWS, 0.3) for i in range(6)},
        **{name: np.ones(ROWS) for name in TRACKER},
    }
    return Campaign("hh150", (Run("cycles", "static", 0.0, columns),))


def visits(compiled: CompiledRobot) -> tuple[Segment, ...]:
    return segments_of(campaign(), compiled, quantities_of(campaign().runs, compiled))


def test_a_pose_that_is_visited_again_is_another_visit() -> None:
    labels = [segment.label for segment in visits(nominal())]
    assert labels == ["cycles, pose 1", *(f"cycles, pose 1, visit {i}" for i in (2, 3, 4))]


def test_what_depends_on_time_is_known_of_each_visit() -> None:
    """Signatures were kept by label: asked for again, every visit had those of the last one."""
    compiled, segments = nominal(), visits(nominal())
    quantities = quantities_of(campaign().runs, compiled)
    drifts = tuple(one for one in nuisances_of(compiled, quantities) if "drift" in one.name)
    assert drifts
    signatures = Signatures(compiled, quantities, drifts, ())
    first, again = (signatures.sensitivities(segments).nuisances for _ in range(2))
    np.testing.assert_array_equal(again, first)
    assert np.ptp(first[[0, 2, 4, 6]], axis=0).max() > 0, "it depends on the time"
