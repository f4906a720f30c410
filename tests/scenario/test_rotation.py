"""What may stand in a rotation scenario."""

from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError

from bench.errors import InputError, ScenarioError
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.scenario.files import read_scenario
from bench.scenario.rotation import CONTROL_PERIOD_S, Rotation
from bench.simulate.env import CONTROL_PERIOD
from bench.simulate.session import run_session, sittings_of
from tests.simulate.rotation_small import small_rotation


def problems(robot: Path, **changes: object) -> str:
    folder = load_robot(robot)
    with pytest.raises(InputError) as caught:
        small_rotation(robot, **changes).check(folder, compile_robot(folder).limits)
    return str(caught.value)


def test_control_period_is_the_environments() -> None:
    assert CONTROL_PERIOD_S == CONTROL_PERIOD


def test_the_published_sweep_comes_along() -> None:
    """Table 7, and a validation over a wider range at other speeds."""
    identification, validation = read_scenario("rotation"), read_scenario("rotation-validation")
    assert isinstance(identification, Rotation)
    assert isinstance(validation, Rotation)
    assert (*identification.start_deg, identification.end_deg) == (0, -20, 0, 0, 90, 0, 40)
    assert len(identification.payloads_kg) == 2
    assert not set(identification.speeds_deg_per_s) & set(validation.speeds_deg_per_s)
    assert validation.start_deg[1] < identification.start_deg[1]
    assert validation.end_deg > identification.end_deg


@pytest.mark.parametrize("changes", [{"sample_period_s": 0.01}, {"joint": 0}, {"speeds_deg_per_s": []}, {"pace": 3}])
def test_what_breaks_the_schema_is_refused(small_robot: Path, changes: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        small_rotation(small_robot, **changes)


def test_ramps_count_towards_the_limits(small_robot: Path) -> None:
    """The joint goes to 114.6 deg; 25 deg/s reached within 1 s take 12.5 deg."""
    limit = np.rad2deg(compile_robot(load_robot(small_robot)).limits[0, 1])
    small_rotation(small_robot, end_deg=limit - 12.6).check(load_robot(small_robot), np.array([[-1, 2], [-2, 2]]))
    assert "12.5 deg on either side for the ramps" in problems(small_robot, end_deg=limit - 12.4)


def test_all_faults_are_listed(small_robot: Path) -> None:
    message = problems(small_robot, start_deg=[60, 170], speeds_deg_per_s=[15, 200], payloads_kg=[5, 40])
    for part in (
        "start_deg[1]: 170 deg",
        "end_deg: joint 1 starts at 60",
        "speeds_deg_per_s[1]",
        "payloads_kg[1]: 40 kg",
    ):
        assert part in message


def test_a_joint_that_is_not_there(small_robot: Path) -> None:
    assert "there is no joint 3" in problems(small_robot, joint=3)
    assert "1 angles" in problems(small_robot, start_deg=[0])


def test_a_scenario_that_takes_for_ever_is_refused(small_robot: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A thousandth of a degree per second, or traverses without end, took all memory."""
    assert "take more than 10 000 seconds" in problems(small_robot, speeds_deg_per_s=[1e-3])
    monkeypatch.setenv("BENCH_MOST_SIMULATED_SECONDS", "100")
    with pytest.raises(ScenarioError, match=r"experiment: takes more than 100 seconds; .*BENCH_MOST_SIMULATED_SECONDS"):
        run_session(small_rotation(small_robot, repeats=10))
    monkeypatch.setenv("BENCH_MOST_SIMULATED_SECONDS", "1000")
    assert sittings_of(small_rotation(small_robot, repeats=10), load_robot(small_robot))


@pytest.mark.parametrize("key", ["move_speed", "acceleration_deg_per_s2"])
def test_moves_that_never_end_are_refused(small_robot: Path, key: str) -> None:
    with pytest.raises(ValidationError, match=key):
        small_rotation(small_robot, **{key: 5e-324})
