"""What a person asks to hide, in words."""

from pathlib import Path

import pytest

from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.hide.request import effects_of
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests.hide.tiny import CATALOGUE


@pytest.fixture(scope="module")
def compiled(small_robot: Path) -> CompiledRobot:
    return compile_robot(load_robot(small_robot))


@pytest.mark.parametrize(
    ("words", "place", "values"),
    [
        (["level@2=0.2"], "joint 2", {"rise": 0.2, "heat": 0}),
        (["level@hinge_b=-2e-1"], "joint 2", {"rise": -0.2, "heat": 0}),
        (["level@1"], "joint 1", {"rise": 0.3, "heat": 0}),
        (["level@1:heat=0.03"], "joint 1", {"rise": 0, "heat": 0.03}),
        (["level@1=0.1", "level@1:heat"], "joint 1", {"rise": 0.1, "heat": 0.02}),
        (["warmth=0.002"], "robot", {"rate": 0.002}),
    ],
)
def test_words(words: list[str], place: str, values: dict[str, float], compiled: CompiledRobot) -> None:
    (one,) = effects_of(words, compiled, CATALOGUE)
    assert str(one.place) == place
    assert one.values == pytest.approx(values)


def test_value_that_means_nothing(compiled: CompiledRobot) -> None:
    with pytest.raises(InputError, match="change is at least -1;"):
        effects_of(["coulomb_level@1=-1.5"], compiled, catalogue())
    with pytest.raises(InputError, match=r"moved is between -0\.5 and 0\.5;"):
        effects_of(["friction_side@1=0.6"], compiled, catalogue())


def test_several_effects_and_the_joint_apart(compiled: CompiledRobot) -> None:
    first, second, third = effects_of(["level=0.2", "warmth", "level@1"], compiled, CATALOGUE, joint=2)
    assert [str(one.place) for one in (first, second, third)] == ["joint 2", "robot", "joint 1"]


def test_all_faults_at_once(compiled: CompiledRobot) -> None:
    words = ["levle=1", "level=0.2", "level@3", "level@1:fall", "warmth=much", "@2"]
    with pytest.raises(InputError) as caught:
        effects_of(words, compiled, CATALOGUE)
    expected = [
        "unknown effect 'levle'. Did you mean 'level'",
        "acts at joint 1, joint 2; say where",
        "unknown place '3'",
        "unknown parameter 'fall'",
        "'much' is not a number",
        "'@2': write NAME",
    ]
    assert len(caught.value.problems) == len(expected)
    for part, problem in zip(expected, caught.value.problems, strict=True):
        assert part in problem


@pytest.mark.parametrize("words", [["level@1=0.1", "level@1=0.2"], ["level@1", "level@hinge_a:rise=0.2"]])
def test_a_parameter_that_is_given_twice(words: list[str], compiled: CompiledRobot) -> None:
    """The last one counted, and nothing was said of the first."""
    with pytest.raises(InputError, match=f"'{words[1]}': rise of effect 'level' at joint 1 is given twice"):
        effects_of(words, compiled, CATALOGUE)
    with pytest.raises(InputError, match="rate of effect 'warmth' is given twice"):
        effects_of(["warmth=0.001", "warmth=0.001"], compiled, CATALOGUE)
