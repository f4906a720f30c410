"""The standard session: parts that can be missing, faults with their places."""

from pathlib import Path

import pytest
from pydantic import ValidationError

from bench.errors import InputError
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.scenario.files import read_as
from bench.scenario.session import PARTS, SessionScenario
from tests.simulate.session_small import SWEEP, small_session


@pytest.mark.parametrize("name", ["session", "session-short"])
def test_those_that_come_along_have_every_part(name: str) -> None:
    scenario = read_as(SessionScenario, name)
    assert all(getattr(scenario, part) for part in PARTS)
    assert 6 <= len(scenario.loading.poses) <= 8
    assert all(len(pose.force_n) == 4 for pose in scenario.loading.poses)
    assert set(scenario.loading.approach) == {1, -1}
    assert scenario.loading.unload
    first = [sweep for sweep in scenario.rotations if sweep.joint == 2]
    assert len({speed for sweep in first for speed in sweep.speeds_deg_per_s}) == 3
    assert all(len(sweep.payloads_kg) == 2 for sweep in first)
    assert (first[0].start_deg[1], first[0].end_deg) == (-35, 105)
    others = [sweep for sweep in scenario.rotations if sweep.joint != 2]
    assert [sweep.joint for sweep in others] == [1, 3, 4, 5, 6]
    assert all(len(sweep.speeds_deg_per_s) == 2 for sweep in others)
    assert scenario.dwell.duration_s == 600


@pytest.mark.parametrize("missing", PARTS)
def test_every_part_can_be_missing(missing: str, small_robot: Path) -> None:
    scenario = small_session(small_robot).without(missing)
    assert not any(key.startswith(missing) for key, _, _ in scenario.parts())
    assert len({(prefix, type(part)) for _, prefix, part in scenario.parts()}) == len(list(scenario.parts()))


def test_a_session_of_nothing_is_refused(small_robot: Path) -> None:
    with pytest.raises(InputError, match="nothing is left"):
        small_session(small_robot).without(*PARTS)
    with pytest.raises(ValidationError, match="needs a part"):
        SessionScenario.model_validate({"experiment": "session", "robot": "small"})


def test_keys_of_the_session_do_not_stand_in_its_parts() -> None:
    with pytest.raises(ValidationError, match="Extra inputs"):
        SessionScenario.model_validate({"experiment": "session", "robot": "small", "rotations": [SWEEP | {"seed": 3}]})


def test_all_faults_of_all_parts_with_their_places(small_robot: Path) -> None:
    scenario = small_session(
        small_robot,
        rotations=[SWEEP, SWEEP | {"joint": 3}],
        dwell={"from_deg": [0], "q_deg": [30, 200], "read_every_s": 60, "simulated_s": 0.1},
    )
    robot = load_robot(small_robot)
    with pytest.raises(InputError) as caught:
        scenario.check(robot, compile_robot(robot).limits)
    expected = [
        "rotations[1].joint: there is no joint 3",
        "dwell.from_deg: 1 angles",
        "dwell.q_deg[1]: 200 deg is outside",
        "dwell.repeats: 3 readings do not fit",
    ]
    assert len(caught.value.problems) == len(expected)
    for words, problem in zip(expected, caught.value.problems, strict=True):
        assert problem.startswith(words)
