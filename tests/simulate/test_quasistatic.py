"""Sessions made of rests alone: which steps matter, and that they end where the session in time ends."""

from pathlib import Path

import numpy as np
import pytest

from bench.simulate.policy import Mark, Script, Step
from bench.simulate.quasistatic import rest_log, turning_points
from bench.simulate.session import run_session
from tests.simulate.loading_small import small_loading


def path(*moves: float) -> list[Step]:
    script = Script(np.zeros(1))
    steps = []
    for move in moves:
        steps += list(script.move(np.array([move]), 1.0))
    return steps + list(script.hold(0.1)) + list(script.read(Mark("run", {"pose": 1.0})))


def test_only_turns_stops_and_readings_are_kept() -> None:
    kept = turning_points(path(0.5, -0.2, -0.4, 0.3))
    np.testing.assert_allclose([step.q_cmd[0] for step in kept], [0.5, -0.4, 0.3, 0.3])
    assert [step.mark is not None for step in kept] == [False, False, False, True]


@pytest.mark.parametrize("friction", ["none", "link", "motor", "as-model"])
def test_ends_where_the_session_in_time_ends(small_robot: Path, friction: str) -> None:
    """Without friction to the last digit that settling leaves; with it, as far as ringing does not shake it loose."""
    scenario = small_loading(small_robot, friction=friction, load_ramp_s=2.0, settle_s=4.0, perfect_instruments=True)
    moving, resting = run_session(scenario), rest_log(scenario)
    assert [step.mark for step in resting.log.steps] == list(moving.marks)
    apart = np.abs(resting.instants.theta - moving.instants.theta)
    wind_up = np.abs(moving.instants.q - moving.instants.theta).max()
    assert apart.max() < (1e-6 if friction == "none" else 0.05) * wind_up
