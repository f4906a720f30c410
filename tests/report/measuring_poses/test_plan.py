"""`bench poses`: from a robot folder to a scenario that runs, and what is said beside it."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tyro
import yaml

from bench.cli.poses import Poses
from bench.errors import InputError
from bench.report.measuring_poses.plan import LOADS_KNOWN, PosePlan, plan_poses, visits_of
from bench.report.measuring_poses.request import PoseRequest
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.scenario.files import read_scenario
from tests.small_robot import write_small_robot

SMALL_RULES = {"floor_m": -1.0, "clearance_m": 0.2, "hanging_height_m": -1.0}


@pytest.fixture(scope="module")
def plan() -> PosePlan:
    return plan_poses(PoseRequest("hh150", against="loading"))


def test_six_poses_are_worth_more_than_the_scenario_s(plan: PosePlan) -> None:
    """The loading scenario holds the reconstructed poses of the paper."""
    assert plan.against == "loading"
    assert plan.efficiency is not None
    assert plan.efficiency > 2
    assert plan.reference is not None
    assert np.all(plan.design.precision.standard_error < plan.reference.standard_error)


def test_scenario_file_fits_the_robot_and_holds_the_design(plan: PosePlan, tmp_path: Path) -> None:
    from bench.report.measuring_poses.tables import write_scenario

    write_scenario(plan, tmp_path / "poses.yaml")
    scenario = read_scenario(tmp_path / "poses.yaml")
    robot = load_robot(scenario.robot)
    scenario.check(robot, compile_robot(robot).limits)
    visits = visits_of(scenario)
    np.testing.assert_allclose(visits.q, plan.design.visits.q, atol=1e-6)
    directions = [[load.direction for load in each.loads] for each in (visits, plan.design.visits)]
    np.testing.assert_allclose(*directions, atol=1e-4)  # a scenario has four digits


def test_robot_of_another_shape(small_robot: Path) -> None:
    """Two hinges about one horizontal axis: hanging loads show both, and there is nothing to compare with."""
    plan = plan_poses(PoseRequest(str(small_robot), count=2, slanting=0, against="loading", **SMALL_RULES))
    assert plan.design.precision.observable.all()
    assert plan.reference is None
    assert plan.efficiency is None


def test_weights_need_no_force_sensor(tmp_path: Path) -> None:
    """`bench identify --method force` runs on weights alone, and `bench poses` refused to plan for it."""
    small = write_small_robot(tmp_path / "small")
    request = PoseRequest(str(small), count=2, slanting=0, method="force", **SMALL_RULES)
    read = plan_poses(request)
    assert read.notes == ()
    figures = yaml.safe_load((small / "figures.yaml").read_text())
    figures["instruments"]["force"] = None
    (small / "figures.yaml").write_text(yaml.safe_dump(figures))
    plan = plan_poses(request)
    assert np.all(plan.design.precision.standard_error > 0)
    assert np.all(plan.design.precision.total_standard_error <= read.design.precision.total_standard_error)
    assert plan.notes == (LOADS_KNOWN,)
    assert plan_poses(replace(request, method="current")).notes == ()


@pytest.mark.parametrize("method", ["current", "force"])
def test_a_tracker_is_needed(tmp_path: Path, method: str) -> None:
    small = write_small_robot(tmp_path / "small")
    figures = yaml.safe_load((small / "figures.yaml").read_text())
    figures["instruments"]["tracker"] = None
    (small / "figures.yaml").write_text(yaml.safe_dump(figures))
    with pytest.raises(InputError, match=f"method '{method}' needs a tracker"):
        plan_poses(PoseRequest(str(small), count=2, slanting=0, method=method, **SMALL_RULES))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"after": "loading"}, "for another robot than 'small'"),
        ({"slant_deg": 90.0}, "between 0 and 90 deg"),
        ({"floor_m": 9.0}, "relax"),
        ({"against": "no_such"}, "no scenario"),
        ({"against": "rotation"}, "not a Loading"),
    ],
)
def test_requests_that_cannot_be_met(small_robot: Path, change: dict[str, object], said: str) -> None:
    request = PoseRequest(str(small_robot), count=2, slanting=0, **SMALL_RULES)
    with pytest.raises(InputError, match=said):
        plan_poses(replace(request, **change))


def test_command_prints_tables(capsys: pytest.CaptureFixture[str]) -> None:
    command = tyro.cli(Poses, args=["--robot", "hh150", "-n", "1", "--after", "loading", "--method", "force"])
    assert command.run() == 0
    printed, during = capsys.readouterr()
    assert during == ""  # what it is at is shown on a terminal
    told: list[str] = []
    plan_poses(command, told.append)
    assert [words.split()[0] for words in told] == ["drawing", "choosing", *["looking"] * 3]
    assert "these after loading" in printed
    assert "loading alone" in printed
    assert "D-efficiency" in printed


def test_command_prints_json_and_what_is_not_observable(capsys: pytest.CaptureFixture[str]) -> None:
    command = tyro.cli(Poses, args=["--robot", "hh150", "-n", "4", "--slanting", "0", "--json", "--against", "None"])
    assert command.run() == 0
    printed = json.loads(capsys.readouterr().out)
    assert len(printed["poses"]) == 4
    assert printed["expected"]["standard_error_nm_per_rad"][0] is None
    assert "will not be observable" in printed["notes"][0]
    assert printed["d_efficiency"] is None
