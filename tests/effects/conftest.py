"""Robots that effects are tried on."""

from pathlib import Path

import pytest

from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import Robot, load_robot


@pytest.fixture(scope="session")
def small(small_robot: Path) -> Robot:
    return load_robot(small_robot)


@pytest.fixture(scope="session")
def small_compiled(small: Robot) -> CompiledRobot:
    return compile_robot(small)


@pytest.fixture(scope="session")
def hh150() -> Robot:
    return load_robot("hh150")


@pytest.fixture(scope="session")
def hh150_compiled(hh150: Robot) -> CompiledRobot:
    return compile_robot(hh150)
