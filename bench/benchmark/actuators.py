"""Custom actuators: the rate of `mj_step` with them against the same model without them."""

from collections.abc import Callable, Sequence
from functools import partial

import mujoco
import numpy as np

from bench.benchmark.clock import interleaved
from bench.benchmark.section import Row
from bench.robot.compiled import read_spec
from bench.robot.folder import load_robot, robot_names

STEPS = 500  # in a block; each block starts from a reset
ROUNDS = 40


def measure(robots: Sequence[str]) -> list[Row]:
    """Return steps per second of each robot; without names, of all that come along."""
    rows = []
    for name in robots or robot_names():
        spent = step_times(read_spec(load_robot(name)))
        ratio = float(np.median(spent[:, 1] / spent[:, 0]))
        rows.append(
            Row(name, STEPS / float(np.median(spent[:, 0])), "mj_step/s", ratio, "of the rate without custom actuators")
        )
    return rows


def step_times(spec: mujoco.MjSpec, rounds: int = ROUNDS) -> np.ndarray:
    """Return the processor time of blocks of steps, with custom actuators and without, shape (rounds, 2) [s].

    Args:
        spec: Model to measure; it is left as it is.
        rounds: Number of blocks of each model.
    """
    model = spec.copy()
    for key in list(model.keys):
        model.delete(key)  # blocks start from a reset, and the activations of a keyframe fit one model only
    bare = model.copy()
    for actuator in [actuator for actuator in bare.actuators if actuator.plugin.active]:
        bare.delete(actuator)
    for shared in [plugin for plugin in bare.plugins if plugin.name]:
        bare.delete(shared)
    return interleaved([_block(model.compile()), _block(bare.compile())], rounds)


def _block(model: mujoco.MjModel) -> Callable[[], None]:
    return partial(_steps, model, mujoco.MjData(model))


def _steps(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    mujoco.mj_resetData(model, data)
    mujoco.mj_step(model, data, STEPS)
