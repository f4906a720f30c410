"""Effects in `fitted.effects` of a robot's figures: from effects that act to entries, through YAML, and back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.effect import WHOLE, Acting, Place
from bench.effects.fitted import entry_of, fitted_acting
from bench.effects.learned import values_at, values_of
from bench.effects.learned_readings import (
    IN_ROOM,
    IN_TIME,
    OF_READING,
    UNDER_FORCE,
    LearnedDrift,
    LearnedLoss,
    LearnedMount,
    LearnedRoom,
    LearnedScale,
)
from bench.errors import RobotError
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests.effects.rest import perfect_reading, some_trace
from tests.small_robot import FIGURES, write_small_robot

SECOND = Place("joint", 1, "hinge_b")
CURRENT = {"channel": "current", "largest": 20.0}
ROUNDING = 1e-12  # of sums whose order depends on where arrays lie in memory
ROOM = np.array([0.1, 0.2, 0.3])
NODES = np.array([-40.0, 0.0, 40.0])
LEARNED = {
    "scale": (LearnedScale(values_of(OF_READING, OF_READING, "A", 1.0), "current", 20.0), SECOND),
    "loss": (LearnedLoss(values_at(NODES, "Nm", "Nm", 1.0), NODES, 1e5, 100.0), SECOND),
    "room": (LearnedRoom(values_of(IN_ROOM[2:5], IN_ROOM[2:5], "m", 1.0), ROOM, 0.8), WHOLE),
    "drift": (LearnedDrift(values_of(IN_TIME, IN_TIME, "m", 1.0), 12.0), WHOLE),
    "mount": (LearnedMount(values_of(UNDER_FORCE, UNDER_FORCE, "m", 1.0), 1, 300.0), WHOLE),
}


def robot_with(folder: Path, effects: list[dict]) -> CompiledRobot:
    write_small_robot(folder)
    (folder / "figures.yaml").write_text(yaml.safe_dump(FIGURES | {"fitted": {"effects": effects}}))
    return compile_robot(load_robot(folder))


@pytest.mark.parametrize("name", LEARNED)
def test_a_learned_error_of_readings_is_the_same_after_yaml(
    name: str, tmp_path: Path, rng: np.random.Generator
) -> None:
    effect, place = LEARNED[name]
    values = {parameter.name: float(x) for parameter, x in zip(effect.parameters, rng.normal(size=99), strict=False)}
    entry = entry_of(Acting(effect, place, values))
    assert entry
    compiled = robot_with(tmp_path, [entry.model_dump(mode="json")])
    (again,) = fitted_acting(compiled)
    assert (again.place, again.values) == (place, values)
    _, trace = some_trace(compiled.robot, rng)
    reading, cold = perfect_reading(compiled, trace), Conditions.reference(2)
    expected = effect.distort(place, values, reading, trace, cold)
    found = again.effect.distort(again.place, again.values, reading, trace, cold)
    assert not np.array_equal(expected.current, reading.current) or not np.array_equal(
        expected.reflectors, reading.reflectors
    )
    np.testing.assert_allclose(found.current, expected.current, rtol=ROUNDING)
    np.testing.assert_allclose(found.reflectors, expected.reflectors, rtol=ROUNDING)


def test_every_effect_of_the_catalogue_at_every_place_is_found_again(tmp_path: Path) -> None:
    compiled = robot_with(tmp_path / "plain", [])
    acting = [
        Acting(effect, place, effect.complete({}))
        for effect in catalogue().values()
        for place in effect.places(compiled)
    ]
    entries = [entry_of(one) for one in acting]
    assert all(entries)
    again = fitted_acting(robot_with(tmp_path / "all", [entry.model_dump(mode="json") for entry in entries if entry]))
    assert [(one.effect.name, one.place, one.values) for one in again] == [
        (one.effect.name, one.place, one.values) for one in acting
    ]


def test_every_fault_is_listed_with_what_is_known(tmp_path: Path) -> None:
    scale = {"effect": "learned_scale", "place": "hinge_b", "values": {"square": 1.0}, "form": CURRENT}
    compiled = robot_with(
        tmp_path,
        [
            {"effect": "encoder_delai", "values": {}},
            {"effect": "coulomb_level", "place": "hinge_c", "values": {"change": 0.1}},
            {"effect": "coulomb_level", "place": "hinge_b", "values": {"chance": 0.1}},
            scale | {"form": {}},
            scale | {"values": {"sqare": 1.0}},
            scale,
        ],
    )
    with pytest.raises(RobotError) as raised:
        fitted_acting(compiled)
    text = str(raised.value)
    for number, words in enumerate(
        (
            "Did you mean 'encoder_delay'?",
            "place of 'coulomb_level' on this robot 'hinge_c'",
            "parameter of 'coulomb_level' 'chance'",
            "form of 'learned_scale': needs channel, largest, not nothing.",
            "Did you mean 'square'?",
        )
    ):
        assert f"fitted.effects[{number}]" in text
        assert words in text
    assert "fitted.effects[5]" not in text


def test_joints_and_reflectors_that_are_not_there_are_faults(small_robot: Path, tmp_path: Path) -> None:
    write_small_robot(tmp_path)
    wrong = {"readings": {"current_offset_a": {"hinge_c": 1.0}, "nest_m": {"nest_4": [0, 0, 1]}}}
    (tmp_path / "figures.yaml").write_text(yaml.safe_dump(FIGURES | {"fitted": wrong}))
    with pytest.raises(RobotError, match=r"(?s)current_offset_a: unknown driven joint 'hinge_c'.*nest_m.*'nest_4'"):
        load_robot(tmp_path)


def test_figures_with_fitted_ones_can_be_a_key(tmp_path: Path) -> None:
    one = robot_with(tmp_path, [{"effect": "encoder_delay", "values": {"delay": 1e-3}}]).robot
    assert {one: 1}[load_robot(tmp_path)] == 1
    assert hash(one) != hash(replace(one, figures=one.figures.model_copy(update={"title": "another"})))
