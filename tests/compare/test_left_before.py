"""How far the robot is from what was recorded before, by the floor of a right model."""

from dataclasses import replace

import pytest

import bench.compare.left_before as module
from bench.compare.background import HELD
from bench.compare.joint import joint_of
from bench.compare.left_before import left_before
from bench.compare.recordings import recordings_of
from bench.diagnose.linearise.other_noise import with_scatter
from bench.effects.catalogue import catalogue
from tests.diagnose.sweeps import LOADS, made, nominal


def test_that_friction_at_rest_repeats_makes_no_robot_worse(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sound machine was "missed 2.3 times as far as by a right model", for rests that repeat scatter less."""
    monkeypatch.setattr(module, "FITS", 0.0)  # all channels
    recordings = recordings_of({"before": made(LOADS, 1)}, {"after": made(LOADS, 2)})
    joint = joint_of(recordings, nominal(), {"gas_loss": catalogue()["gas_loss"]})
    held = replace(joint, linear=with_scatter(joint.linear, replace(joint.linear.scatter, new=HELD)))
    assert left_before(joint)
    assert [one.column for one in left_before(held)] == [one.column for one in left_before(joint)]
    for one, other in zip(left_before(held), left_before(joint), strict=True):
        assert one.times == pytest.approx(other.times, rel=1e-9)
