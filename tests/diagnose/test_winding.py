"""Gears wind up along a motion: a replay against an elastic arm that another program integrates in time."""

import numpy as np
import pytest

from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.winding import MotionSpline
from bench.diagnose.replay.world import NOMINAL
from bench.record.campaign import Array, Campaign
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.elastic_arm import elastic


def test_a_soft_arm_is_repeated_as_it_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    """Drives 1 to 3 were missed by 8.0, 5.5 and 1.2 Nm of 3 kNm, with products of inertia and acceleration besides."""
    compiled = compile_robot(load_robot("kr300"))
    run = elastic(compiled, 10.0)
    quantities = quantities_of((run,), compiled)
    segments = segments_of(Campaign("kr300", (run,)), compiled, quantities)

    def left() -> Array:
        """Return the root mean square of what is missed of each torque, shape (6,) [Nm]."""
        missed = segments[0].observed - Replay(compiled, segments, quantities).predict(NOMINAL)
        return np.sqrt(np.nanmean(missed**2, axis=0))

    wound = left()
    monkeypatch.setattr(MotionSpline, "rates", lambda _, winding: np.zeros((2, *winding.shape)))
    stiff = left()
    print("missed [Nm]:", stiff.round(2), "with links as their motors,", wound.round(2), "with gears that wind up")
    assert np.all(stiff[:2] > 5)
    assert np.all(wound[:2] < stiff[:2] / 5)
    assert np.all(wound[:3] < (1.5, 0.5, 0.2))
    assert np.all(wound < 1.02 * stiff)
