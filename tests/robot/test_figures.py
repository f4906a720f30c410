"""What the figures of a robot say of it as a whole."""

import pytest

from bench.robot.figures import Figures
from bench.robot.folder import load_robot


def named(*names: str) -> Figures:
    figures = load_robot("hh150").figures
    drives = (one.model_copy(update={"joint": name}) for one, name in zip(figures.drives, names, strict=False))
    return figures.model_copy(update={"drives": tuple(drives), "title": "An arm"})


def test_joints_that_have_other_names_than_their_numbers_are_told() -> None:
    """Behind a rail, "joint 4" was joint a3 of the user's, on the same page."""
    figures = named("rail", "a1", "a2")
    assert figures.by_number == "joint 1 is rail, 2 a1, 3 a2"
    assert figures.titled == "An arm (joint 1 is rail, 2 a1, 3 a2)"


@pytest.mark.parametrize("names", [("joint1", "joint2"), ("A1", "A2"), ("x_axis_01", "x_axis_02")])
def test_joints_that_are_named_by_their_numbers_need_no_word(names: tuple[str, ...]) -> None:
    assert named(*names).titled == "An arm"


def test_eleven_is_not_one() -> None:
    assert named("a11", "a12").by_number == "joint 1 is a11, 2 a12"
