"""Scenario files: those that come along are valid, broken ones are told all their faults at once."""

from pathlib import Path

import pytest
import yaml

from bench.errors import InputError
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.scenario.files import read_scenario, scenario_names

GOOD = {
    "experiment": "loading",
    "robot": "small",
    "poses": [{"q_deg": [20, 10], "force_n": [100, 250]}],
}


def written(folder: Path, **changes: object) -> Path:
    file = folder / "mine.yaml"
    file.write_text(yaml.safe_dump(GOOD | changes))
    return file


@pytest.mark.parametrize("name", scenario_names())
def test_scenarios_that_come_along_fit_their_robot(name: str) -> None:
    scenario = read_scenario(name)
    robot = load_robot(scenario.robot)
    scenario.check(robot, compile_robot(robot).limits)


def test_reads_a_file_of_ones_own(tmp_path: Path) -> None:
    scenario = read_scenario(written(tmp_path))
    assert scenario.poses[0].force_n == (100, 250)
    assert scenario.repeats == 10


def test_all_faults_of_the_keys_at_once(tmp_path: Path) -> None:
    file = written(tmp_path, repeats=0, speed=3, friction="both", poses=[{"q_deg": [20, "x"]}])
    with pytest.raises(InputError) as caught:
        read_scenario(file)
    said = caught.value.problems
    assert any("speed: unknown key 'speed'. Did you mean 'seed'?" in problem for problem in said)
    for place in ("repeats", "speed", "friction", "poses[0].q_deg[1]", "poses[0].force_n"):
        assert any(f"mine.yaml: {place}:" in problem for problem in said), (place, said)


def test_all_faults_against_the_robot_at_once(tmp_path: Path, small_robot: Path) -> None:
    poses = [
        {"q_deg": [20, 10, 5], "force_n": [100]},
        {"q_deg": [200, 10], "force_n": [100, 301], "direction": [0, 0, 0]},
        {"q_deg": [-56, 10], "force_n": [100]},
    ]
    scenario = read_scenario(written(tmp_path, robot=str(small_robot), poses=poses))
    robot = load_robot(scenario.robot)
    with pytest.raises(InputError) as caught:
        scenario.check(robot, compile_robot(robot).limits)
    expected = [
        "poses[0].q_deg: 3 angles",
        "poses[1].q_deg[0]: 200.0 deg is outside",
        "poses[1].direction: is zero",
        "poses[1].force_n[1]: 301 N is above the rating",
        "poses[2].q_deg[0]: the approach over 3.0 deg",
    ]
    assert [any(problem.startswith(words) for problem in caught.value.problems) for words in expected] == [True] * 5
    assert len(caught.value.problems) == 5


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("experiment: [", "not YAML"),
        ("- 1", "is not a list"),
        ("experiment: loding", "Did you mean 'loading'"),
        ("", "is not a list"),
    ],
)
def test_what_is_no_scenario(tmp_path: Path, text: str, said: str) -> None:
    file = tmp_path / "mine.yaml"
    file.write_text(text)
    with pytest.raises(InputError, match=said):
        read_scenario(file)


def test_missing_file_names_those_that_come_along() -> None:
    with pytest.raises(InputError, match=r"no scenario file 'nowhere/lost.yaml'.*loading"):
        read_scenario("nowhere/lost.yaml")
