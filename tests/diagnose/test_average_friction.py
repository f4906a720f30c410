"""Friction that falls steeply near standstill is averaged along the motion, as currents are."""

from dataclasses import replace

import numpy as np
import pytest

import bench.diagnose.replay.averaged_more as more_module
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.record.campaign import Campaign
from tests.diagnose.assumed.motion import JOINT, START, TIME, setting

RISE, FALLS = 0.5, 0.1  # [rad/s]
SWING, PERIOD = 0.3, 3.0  # [rad], [s]; bins of a sixth of a second pass over 0.1 rad/s where it turns round


def test_a_rise_at_standstill_that_bins_pass_over_is_averaged(monkeypatch: pytest.MonkeyPatch) -> None:
    """Taken at the average speed, two fifths of what it makes of the bins beside a turn were missed."""
    compiled, run = setting()
    phase = 2 * np.pi * TIME / PERIOD
    columns = {"time_s": TIME, f"current_{JOINT + 1}_a": np.zeros(len(TIME))}
    columns |= {f"q_motor_{i + 1}_rad": np.zeros(len(TIME)) for i in range(compiled.n_joints)}
    columns[f"q_motor_{JOINT + 1}_rad"] = START + SWING * (1 - np.cos(phase))
    current = Quantity(f"current_{JOINT + 1}_a", "current", "A", JOINT)
    segments = segments_of(Campaign("hh150", (replace(run, columns=columns),)), compiled, (current,))
    (segment,) = segments
    effect = catalogue()["stribeck"]
    world = World(acting=(Acting(effect, effect.places(compiled)[JOINT], {"rise": RISE, "speed": FALLS}),))

    def change() -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
        replay = Replay(compiled, segments, (current,))
        return np.asarray(replay.predict(world) - replay.predict(NOMINAL))[:, 0]

    assert segment.path
    speed = 2 * np.pi / PERIOD * SWING * np.sin(phase)
    level = (compiled.motor_coulomb + compiled.link_coulomb)[JOINT] / compiled.torque_constant[JOINT]
    risen = RISE * level * np.exp(-((speed / FALLS) ** 2)) * np.sign(speed)
    true = np.array([weights @ risen[rows] for rows, weights in segment.path.of_torque])
    seen = np.isfinite(segment.observed[:, 0]) & (np.abs(true) > 0.01 * RISE * level)
    assert seen.sum() >= 4  # before and after each turn
    averaged = change()
    monkeypatch.setattr(more_module, "average_friction", lambda robot, path, speed: np.zeros_like(speed))
    at_average = change()
    missed, before = (np.abs(one - true)[seen].sum() / np.abs(true)[seen].sum() for one in (averaged, at_average))
    print(f"missed of the rise: {missed:.3f}, at the average speed {before:.3f}")
    assert missed < 0.1
    assert before > 0.2
