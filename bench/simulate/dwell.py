"""Dwelling as a policy."""

from collections.abc import Iterator

import numpy as np

from bench.robot.folder import Robot
from bench.scenario.dwell import DwellPart
from bench.simulate.env import CONTROL_PERIOD
from bench.simulate.policy import Array, Mark, Script, Sitting, Step

RUN = "dwell"


def dwell_sittings(scenario: DwellPart, robot: Robot) -> tuple[Sitting, ...]:
    """Return the dwell: one sitting that begins at rest where the robot comes from."""
    start = np.deg2rad(np.array(scenario.from_deg))
    return (Sitting(start, dwell_policy(scenario, robot, start)),)


def dwell_policy(scenario: DwellPart, robot: Robot, start: Array) -> Iterator[Step]:
    """Yield the steps of a dwell: one static run of one unloaded state, whose repeats are spread over time."""
    top_speed = scenario.move_speed * np.array([drive.speed_limit_rad_per_s for drive in robot.figures.drives])
    script = Script(start)
    yield from script.move(np.deg2rad(scenario.q_deg), top_speed, float(np.deg2rad(scenario.acceleration_deg_per_s2)))
    yield from script.say(f"dwell for {scenario.duration_s:g} s")
    reading = scenario.repeats * scenario.repeat_interval_s
    simulated = scenario.read_every_s if scenario.simulated_s is None else scenario.simulated_s
    way = np.deg2rad(scenario.q_deg) - start
    labels = {"pose": 1.0, "approach": 1.0 if way[np.argmax(np.abs(way))] >= 0 else -1.0, "load_step": 0.0}
    repeat = 0
    for _ in range(scenario.n_times):
        if scenario.read_every_s > simulated:
            yield from script.wait(scenario.read_every_s - simulated)
        yield from script.hold(simulated - reading)
        for _ in range(scenario.repeats):
            repeat += 1
            yield from script.hold(scenario.repeat_interval_s - CONTROL_PERIOD)
            yield from script.read(Mark(RUN, labels | {"repeat": float(repeat)}))
