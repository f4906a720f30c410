"""Numbers in YAML are decimal: what YAML 1.1 takes for one besides is refused, and `true` is no 1."""

from pathlib import Path

import pytest

from bench.errors import RobotError
from bench.record.check import check_campaign
from bench.record.yaml_text import YamlFault, load_typed_yaml
from bench.robot.folder import load_robot
from tests.record.build import motion, sweep, write_folder
from tests.small_robot import write_small_robot

ODD = ("0x10", "0b11", "010", "-007", "1_000", "1_000.5", "1_0e1", "1:30", "1:30.5", "190:20:30")
SPEED = "speed_limit_rad_per_s: 2.0"


def loaded(tmp_path: Path, value: str) -> object:
    file = tmp_path / "a.yaml"
    file.write_text(f"a: 1\nb: {value}\n")
    return load_typed_yaml(file)["b"]


@pytest.mark.parametrize("value", ODD)
def test_what_is_no_decimal_number_is_refused_with_its_line(tmp_path: Path, value: str) -> None:
    with pytest.raises(YamlFault, match=f"line 2: '{value}' is no decimal number"):
        loaded(tmp_path, value)
    assert loaded(tmp_path, f"'{value}'") == value  # a name


@pytest.mark.parametrize(
    ("value", "number"),
    [("0", 0), ("-3", -3), ("+2.5", 2.5), ("0.5", 0.5), (".5", 0.5), ("2.", 2), ("007.5", 7.5), ("1.0e-3", 1e-3)],
)
def test_decimal_numbers_are_read(tmp_path: Path, value: str, number: float) -> None:
    assert loaded(tmp_path, value) == number


@pytest.mark.parametrize("word", ["true", "yes", "on", "no", "False"])
def test_a_word_for_yes_or_no_is_no_number(tmp_path: Path, word: str) -> None:
    folder = write_small_robot(tmp_path / "robot")
    file = folder / "figures.yaml"
    file.write_text(file.read_text().replace(SPEED, f"speed_limit_rad_per_s: {word}", 1))
    with pytest.raises(RobotError, match=rf"robot/figures\.yaml: drives\[0\]\.speed_limit_rad_per_s: .*'{word}'"):
        load_robot(folder)


@pytest.mark.parametrize(
    ("value", "is_sound"), [("may", True), ("Größe 1", True), (r"a\nb", False), (r"\x1b[1m", False)]
)
def test_the_name_of_a_recording_is_one_line_of_text(tmp_path: Path, value: str, is_sound: bool) -> None:
    folder = write_folder(tmp_path / "campaign", motion(sweep()))
    run = f'{{name: a, kind: motion, start_s: 0, recording: "{value}"}}'
    (folder / "campaign.yaml").write_text(f"format: 1\nrobot: r\nruns: [{run}]")
    found = [finding.column for finding in check_campaign(folder).errors if finding.file == "campaign.yaml"]
    assert found == ([] if is_sound else ["runs[0].recording"])


@pytest.mark.parametrize("given", ["current: 1e6", "current: 1e-13", "q_motor: 100", "gas_pressure: 1e9"])
def test_a_noise_that_no_instrument_has_is_refused(tmp_path: Path, given: str) -> None:
    folder = write_folder(tmp_path / "campaign", motion(sweep()))
    file = folder / "campaign.yaml"
    file.write_text(file.read_text() + f"noise: {{{given}}}\n")
    assert [finding.column for finding in check_campaign(folder).errors] == [f"noise.{given.split(':')[0]}"]
