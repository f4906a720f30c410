"""What the environment reads at a glance is what the instruments read."""

from pathlib import Path

import numpy as np
import pytest

from bench.robot.compiled import compile_robot
from bench.robot.folder import Robot, load_robot
from bench.simulate.glance import Glance
from bench.simulate.instruments import Instruments
from bench.simulate.plant import Plant

ROUNDING = 1e-12  # of the largest reading: a sum in another order
NAMES = ("q_motor", "q_link", "current", "torque", "force", "moment", "reflectors", "gas_pressure")


def names_of(robot: Robot) -> tuple[str, ...]:
    f = robot.figures.instruments
    there = (f.encoder, f.link_encoder, f.current, f.torque, f.force, f.force, f.tracker, f.pressure)
    return tuple(name for name, instrument in zip(NAMES, there, strict=True) if instrument)


@pytest.mark.parametrize("name", ["small", "hh150", "kr300", "emps"])
@pytest.mark.parametrize("tails", [None, 5.0])
def test_same_readings(name: str, tails: float | None, small_robot: Path) -> None:
    robot = load_robot(str(small_robot) if name == "small" else name)
    plant, n = Plant(robot), robot.n_joints
    plant.reset(np.zeros(n))
    read, glanced = (Instruments(plant.compiled, np.random.default_rng(7), tails) for _ in range(2))
    glance = Glance(glanced, plant.trace_of, plant.step(np.zeros(n), np.zeros(6), 4e-3).shape[1], names_of(robot))
    hanging, slanting = np.array([0, 0, -50.0, 0, 0, 0]), np.array([9.0, -5.0, -50.0, 1.0, 2.0, 3.0])
    for i in range(30):
        record = plant.step(np.full(n, 1e-4 * i), hanging if i < 15 else slanting, 4e-3)
        if i == 10:
            read.move_reflector()
            glanced.move_reflector()
        expected = read.read(plant.trace_of(record))
        seen = glance.read(record[0])
        assert tuple(seen) == names_of(robot)
        for key, values in seen.items():
            truth = np.nan_to_num(getattr(expected, key)[0])
            np.testing.assert_allclose(
                values, truth, rtol=0, atol=ROUNDING * max(1.0, np.abs(truth).max()), err_msg=key
            )


def test_a_reading_is_not_overwritten_by_the_next(small_robot: Path) -> None:
    robot = load_robot(str(small_robot))
    plant = Plant(robot)
    plant.reset(np.zeros(2))
    instruments = Instruments(compile_robot(robot), np.random.default_rng(1))
    glance = Glance(instruments, plant.trace_of, plant.step(np.zeros(2), np.zeros(6), 4e-3).shape[1], names_of(robot))
    first = glance.read(plant.step(np.full(2, 0.1), np.zeros(6), 4e-3)[0])
    kept = {name: values.copy() for name, values in first.items()}
    glance.read(plant.step(np.full(2, 0.3), np.zeros(6), 4e-3)[0])
    for name, values in kept.items():
        np.testing.assert_array_equal(first[name], values)
