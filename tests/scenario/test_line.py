"""The line's scenario: the one that comes along is Table 8, broken ones are told what is wrong."""

import csv

import numpy as np
import pytest
from pydantic import ValidationError

from bench.errors import InputError
from bench.robot.bodies import Point, read_only
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.kinematics import place, place_and_jacobian
from bench.robot.links import rigid_bodies
from bench.scenario.files import read_scenario
from bench.scenario.line import Line

# models/hh150/paper/README.md: joint angles at U and V, reconstructed [deg]
AT_U = {1: 2.6, 2: 38.0, 4: 49.0}
AT_V = {1: 27.6, 2: 3.9, 4: 59.0}
PRINTED = 0.6  # [deg]; q5 is given in whole degrees


@pytest.fixture(scope="module")
def table_8() -> Line:
    scenario = read_scenario("line")
    assert isinstance(scenario, Line)
    return scenario


def check(scenario: Line, **changes: object) -> None:
    robot = load_robot(scenario.robot)
    changed = Line.model_validate(scenario.model_dump() | changes)
    changed.check(robot, compile_robot(robot).limits)


def test_joint_angles_are_the_reconstructed_ones(table_8: Line) -> None:
    path = table_8.path(rigid_bodies(compile_robot(load_robot(table_8.robot))))
    degrees = np.rad2deg(path.at(np.linspace(0, path.length, 200)))
    for row, expected in ((0, AT_U), (-1, AT_V)):
        for joint, angle in expected.items():
            assert degrees[row, joint] == pytest.approx(angle, abs=PRINTED)
    assert np.all(np.diff(degrees[:, 2]) < 0), "theta_3 falls all the way from U to V (section 6)"
    np.testing.assert_allclose(degrees[:, [0, 3, 5]], 0, atol=1e-6)


def test_the_line_is_that_of_table_8_and_the_tool_points_down(table_8: Line) -> None:
    bodies = rigid_bodies(compile_robot(load_robot(table_8.robot)))
    path = table_8.path(bodies)
    assert (table_8.speed_m_per_s, table_8.force_n, path.length) == (0.01, 1500, pytest.approx(0.6))
    flange = bodies.points["flange"]
    for distance, x in ((0.0, 1.2), (0.6, 1.8)):
        here = place(bodies, flange, path.at(np.array([distance]))[0])
        tip = here.position + (0.4 - 0.225) * np.array([0, 0, -1])  # flange face at 0.225 m of the tool's 0.4 m
        np.testing.assert_allclose(tip - [0, 0, 0.683], [x, 0, 0.116], atol=1e-9)


def test_all_faults_at_once(table_8: Line) -> None:
    with pytest.raises(InputError) as error:
        check(
            table_8,
            near_deg=(0, 1, 2),
            force_n=1600,
            sample_period_s=0.028,
            approach=(0, 0, 0),
            tool_point="tip",
            corrections={"share": (0, 0.4, 0.6, 1), "out_rad": ((0, 0),) * 4, "back_rad": ((0,) * 6,) * 4},
        )
    message = str(error.value)
    for part in ("3 angles", "above the rating", "whole number", "approach: is zero", "unknown point", "out_rad"):
        assert part in message, message


def test_lines_that_the_arm_cannot_follow(table_8: Line) -> None:
    with pytest.raises(InputError, match="cannot be followed"):
        check(table_8, end_m=(3.6, 0, 0.116), sample_period_s=0.1)
    with pytest.raises(InputError, match="joint 3 would turn"):
        check(table_8, speed_m_per_s=3.0, sample_period_s=0.04, lead_in_s=0.04)


@pytest.mark.parametrize(
    ("share", "rows", "words"),
    [((0, 0.5, 0.4, 1), 4, "grow from 0 to 1"), ((0, 0.5, 0.9, 1), 3, "one row per knot"), ((0, 1), 2, "at least 4")],
)
def test_corrections_of_the_wrong_form(table_8: Line, share: tuple[float, ...], rows: int, words: str) -> None:
    table = ((0.0,) * 6,) * rows
    content = table_8.model_dump() | {"corrections": {"share": share, "out_rad": table, "back_rad": table}}
    with pytest.raises(ValueError, match=words):
        Line.model_validate(content)


def test_corrections_may_not_leave_the_range(table_8: Line) -> None:
    table = ((0, 0, 0.5, 0, 0, 0),) * 4
    with pytest.raises(InputError, match="take joint 3 out of its range"):
        check(table_8, corrections={"share": (0, 0.3, 0.6, 1), "out_rad": table, "back_rad": table})


@pytest.mark.parametrize(("row", "at_u", "at_v"), [("Current", -1.28, -2.85), ("Force", -1.04, -2.42)])
def test_deflection_by_table_6_is_the_reconstructed_one(table_8: Line, row: str, at_u: float, at_v: float) -> None:
    """J_m K^-1 J_f^T W at the tool point; models/hh150/paper/README.md, to the digits given there [mm]."""
    robot = load_robot(table_8.robot)
    bodies = rigid_bodies(compile_robot(robot))
    with (robot.folder / "paper" / "table6.csv").open() as lines:
        stiffness = {line["method"].lower(): line for line in csv.DictReader(lines)}[row.lower()]
    k = np.array([float(stiffness[f"k{j}_nm_per_rad"]) for j in range(1, 7)])
    path, tip = table_8.path(bodies), Point(5, read_only([0, 0, -0.4]), read_only(np.eye(3)))
    for q, expected in zip(path.at(np.array([0.0, path.length])), (at_u, at_v), strict=True):
        jacobian = place_and_jacobian(bodies, tip, q)[1][:3]
        deflection = jacobian @ (jacobian.T @ [0, 0, -table_8.force_n] / k)
        assert 1e3 * deflection[2] == pytest.approx(expected, abs=0.02)


@pytest.mark.parametrize(("key", "value"), [("start_m", [0.0, -1e300, 0.0]), ("sample_period_s", 1e-9)])
def test_numbers_beyond_any_line_are_refused(table_8: Line, key: str, value: object) -> None:
    content = table_8.model_dump()
    with pytest.raises(ValidationError, match=key):
        Line.model_validate(content | {key: value})


def test_lines_that_never_end_are_refused(table_8: Line) -> None:
    """A lead-in of 1e300 s ended in a traceback, a speed of 1e-300 m/s in nothing."""
    with pytest.raises(ValidationError, match="lead_in_s"):
        check(table_8, lead_in_s=1e300)
    with pytest.raises(InputError, match="more than 10 000 seconds"):
        check(table_8, speed_m_per_s=1e-300)
