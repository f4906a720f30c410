"""The Gymnasium environment: periods taken one by one against the same periods handed over at once."""

from collections.abc import Sequence

import numpy as np

from bench.benchmark.clock import interleaved
from bench.benchmark.section import Row
from bench.robot.folder import robot_names
from bench.simulate.env import CONTROL_PERIOD, BenchEnv

PERIODS = 250  # one second
ROUNDS = 10


def measure(robots: Sequence[str]) -> list[Row]:
    """Return steps per second of `BenchEnv`; without names, of all robots that come along."""
    rows = []
    for name in robots or robot_names():
        env = BenchEnv(name)
        env.reset(seed=1)
        rest = env.plant.look()
        command, wrench = rest.q[0].copy(), np.zeros(6)

        def one_by_one(env: BenchEnv = env, q_cmd: np.ndarray = command, wrench: np.ndarray = wrench) -> None:
            for _ in range(PERIODS):
                env.step({"q_cmd": q_cmd, "wrench": wrench})

        def at_once(env: BenchEnv = env, q_cmd: np.ndarray = command, wrench: np.ndarray = wrench) -> None:
            trace = env.plant.advance(np.tile(q_cmd, (PERIODS, 1)), np.tile(wrench, (PERIODS, 1)), CONTROL_PERIOD)
            env.instruments.read(trace)

        spent = interleaved([one_by_one, at_once], ROUNDS)
        ratio = float(np.median(spent[:, 1] / spent[:, 0]))
        rows.append(
            Row(
                name,
                PERIODS / float(np.median(spent[:, 0])),
                "step/s",
                ratio,
                "of the rate of the same periods at once",
            )
        )
        env.close()
    return rows
