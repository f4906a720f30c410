"""Figures of a robot that nobody can have meant."""

from dataclasses import replace
from typing import Any

import pytest

from bench.diagnose.plausibility.stated_figures import remarks_on
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot, robot_names


def stating(robot: CompiledRobot, path: tuple[str | int, ...], value: float) -> CompiledRobot:
    content: dict[str, Any] = robot.robot.figures.model_dump()
    at: Any = content
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    return replace(robot, robot=replace(robot.robot, figures=type(robot.robot.figures).model_validate(content)))


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        (("uncertainty", "mass"), 5.0, "500% uncertain"),
        (("drives", 1, "torque_constant_error"), 2.0, "per cent? write 0.02"),
        (("instruments", "current", "sigma_a"), 99.0, "more than a drive has"),
        (("instruments", "encoder", "resolution_rad"), 0.01, "resolution_rad"),
        (("instruments", "encoder", "delay_s"), 4.0, "milliseconds?"),
    ],
)
def test_a_figure_that_nobody_meant_is_remarked(
    robot: CompiledRobot, path: tuple[str | int, ...], value: float, words: str
) -> None:
    (remark,) = remarks_on(stating(robot, path, value))
    assert remark.level == "warning"
    assert str(path[-1]) in remark.column
    assert words in str(remark)


def test_of_a_list_the_number_that_nobody_meant_is_remarked(robot: CompiledRobot) -> None:
    content = robot.robot.figures.model_dump()
    content["uncertainty"]["friction"] = [0.05, 5, 0.05, 0.05, 0.05, 0.05]
    figures = type(robot.robot.figures).model_validate(content)
    (remark,) = remarks_on(replace(robot, robot=replace(robot.robot, figures=figures)))
    assert remark.column == "uncertainty.friction[1]"
    assert "500% uncertain" in str(remark)


@pytest.mark.parametrize("name", robot_names())
def test_no_robot_of_ours_is_remarked(name: str) -> None:
    assert not list(remarks_on(compile_robot(load_robot(name))))
