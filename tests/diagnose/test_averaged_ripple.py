"""Friction that ripples within a bin is averaged along the motion in the replay, as currents are in the data."""

import numpy as np
import pytest

from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import NOMINAL, World
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.diagnose.noise_free import linearised, noise_free

PERIOD = 0.09  # [rad]; at 40 deg/s a bin passes over a whole one
RUNS = ("joint2-payload100-speed40-up", "joint2-payload50-speed40-down")


def test_a_ripple_that_bins_pass_over_is_averaged(monkeypatch: pytest.MonkeyPatch) -> None:
    """Taken in the middle of each bin, more was missed than the ripple makes."""
    compiled = compile_robot(load_robot("hh150"))
    effect = catalogue()["friction_ripple"]
    place = effect.places(compiled)[1]
    acting = (Acting(effect, place, {"sin": -0.01, "cos": -0.05, "period": PERIOD}),)
    replay = linearised(noise_free("session-study", acting=acting)).replay
    plain = linearised(noise_free("session-study")).replay
    current = [quantity.column for quantity in replay.quantities].index("current_2_a")
    seen, before = (np.concatenate([s.observed for s in one.segments])[:, current] for one in (replay, plain))
    change = seen - before
    nominal, averaged = (replay.predict(world)[:, current] for world in (NOMINAL, World(acting=acting)))
    monkeypatch.setattr(Replay, "_averaged", lambda self, world: 0.0)
    middle = replay.predict(World(acting=acting))[:, current]
    run_of = np.repeat([s.run for s in replay.segments], [len(s) for s in replay.segments])
    for run in RUNS:
        rows = run_of == run
        size, of_middle, of_average = (
            float(np.sqrt(np.mean(part[rows] ** 2)))
            for part in (change, change - middle + nominal, change - averaged + nominal)
        )
        print(f"{run}: {size:.3f} A; missed in the middle {of_middle:.3f}, averaged {of_average:.3f}")
        assert of_middle > 2 * size
        assert of_average < size / 2
