"""How well drives are known: one number for all, or a list with one for each."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from bench.errors import RobotError
from bench.robot.figures import Figures, Uncertainty
from bench.robot.folder import load_robot
from tests.small_robot import FIGURES, write_small_robot

KEYS = ("friction", "rotor_inertia", "stiffness")


def stating(folder: Path, **uncertainty: object) -> Path:
    write_small_robot(folder)
    (folder / "figures.yaml").write_text(yaml.safe_dump(FIGURES | {"uncertainty": uncertainty}))
    return folder


@pytest.mark.parametrize("key", KEYS)
def test_one_number_is_that_of_each_drive(key: str, tmp_path: Path) -> None:
    one, each = (
        load_robot(stating(tmp_path / name, **{key: value})).figures.drive_uncertainty
        for name, value in (("one", 0.3), ("each", [0.3, 3]))
    )
    np.testing.assert_array_equal(getattr(one, key), [0.3, 0.3])
    np.testing.assert_array_equal(getattr(each, key), [0.3, 3])
    for other in set(KEYS) - {key}:
        np.testing.assert_array_equal(getattr(each, other), [Uncertainty.model_fields[other].default] * 2)
    assert not getattr(each, key).flags.writeable


def test_rotors_that_nobody_knows_are_told_drive_by_drive() -> None:
    stated = Uncertainty.model_validate({"rotor_inertia": [0.1, 3, 1.0, 0.99]})
    assert stated.of_drives(4).rotor_is_unknown.tolist() == [False, True, True, False]


@pytest.mark.parametrize("key", KEYS)
@pytest.mark.parametrize(
    ("value", "said"),
    [
        ([0.1], "top level: {} needs one number, or one for each of the 2 drives, not a list of 1"),
        ([], "top level: {} needs one number, or one for each of the 2 drives, not a list of 0"),
        ([0.1, 0.1, 3], "top level: {} needs one number, or one for each of the 2 drives, not a list of 3"),
        (-1, "{}: Input should be greater than or equal to 0, not '-1'"),
        ([0.1, 1000], "{}[1]: Input should be less than or equal to 100, not '1000'"),
        ([0.1, [0.1]], "{}[1]: Input should be a valid number"),
        ("rough", "{}: Input should be a valid number, unable to parse string as a number, not 'rough'"),
    ],
)
def test_what_cannot_be_is_one_error_with_its_place(key: str, value: object, said: str, tmp_path: Path) -> None:
    folder = stating(tmp_path, **{key: value})
    with pytest.raises(RobotError) as error:
        load_robot(folder)
    assert error.value.problems == (f"{folder / 'figures.yaml'}: " + said.format(f"uncertainty.{key}"),)


def test_noise_of_torques_is_stated_in_the_same_way(tmp_path: Path) -> None:
    """A list with a number below zero had two faults: it is no number, and one of its numbers cannot be."""
    folder = write_small_robot(tmp_path)
    instruments = FIGURES["instruments"] | {"torque": {"sigma_nm": [1, -1]}}  # type: ignore[operator]
    (folder / "figures.yaml").write_text(yaml.safe_dump(FIGURES | {"instruments": instruments}))
    with pytest.raises(RobotError) as error:
        load_robot(folder)
    (problem,) = error.value.problems
    assert "instruments.torque.sigma_nm[1]: " in problem


def test_lists_of_a_wrong_length_are_told_together(tmp_path: Path) -> None:
    with pytest.raises(RobotError) as error:
        load_robot(stating(tmp_path, friction=[0.1], stiffness=[3, 3, 3]))
    assert all(words in str(error.value) for words in ("uncertainty.friction needs", "uncertainty.stiffness needs"))


def test_a_list_is_read_back_as_it_was() -> None:
    figures = Figures.model_validate(FIGURES | {"uncertainty": {"rotor_inertia": [0.1, 3]}})
    assert Figures.model_validate(figures.model_dump()) == figures
    assert figures.model_dump(mode="json", exclude_unset=True)["uncertainty"] == {"rotor_inertia": [0.1, 3.0]}
