"""Numbers that no robot has are refused where they stand; those of small and of large robots are not."""

from pathlib import Path

import mujoco
import pytest
import yaml

from bench.errors import RobotError
from bench.robot.checks import unlike_a_robot
from bench.robot.compiled import compile_robot
from bench.robot.figures import Figures
from bench.robot.folder import load_robot, robot_names
from bench.robot.instrument_table import PARTS
from bench.robot.plausible import implausible
from bench.robot.starter.folder import start_robot
from bench.robot.starter.source import read_source
from bench.robot.trial import MOST_TOLD
from tests import stranger
from tests.small_robot import FIGURES, MJCF, write_small_robot

DESKTOP = {
    'mass="40.0"': 'mass="0.05"',
    'mass="25.0"': 'mass="0.05"',
    'diaginertia="2.2 2.1 0.2"': 'diaginertia="1e-4 1e-4 1e-5"',
    'diaginertia="0.12 1.1 1.0"': 'diaginertia="1e-5 1e-4 1e-4"',
    'armature="40.0"': 'armature="1e-6"',
    'armature="20.0"': 'armature="1e-6"',
    'stiffness="200000.0" damping="400.0"': 'stiffness="50" damping="0.001"',
    'stiffness="100000.0" damping="200.0"': 'stiffness="50" damping="0.001"',
    'forcerange="-9000 9000"': 'forcerange="-1.5 1.5"',
    'value="60.0"': 'value="0.05"',
    'value="30.0"': 'value="0.05"',
    'kp="144000.0" kv="4800.0" ki="1440000.0"': 'kp="0.01" kv="1e-4" ki="0.001"',
    'kp="72000.0" kv="2400.0" ki="720000.0"': 'kp="0.01" kv="1e-4" ki="0.001"',
}
TITAN = {
    'mass="40.0"': 'mass="1200"',
    'mass="25.0"': 'mass="800"',
    'diaginertia="2.2 2.1 0.2"': 'diaginertia="600 600 100"',
    'diaginertia="0.12 1.1 1.0"': 'diaginertia="50 400 400"',
    'armature="40.0"': 'armature="9000"',
    'stiffness="200000.0"': 'stiffness="2e7"',
    'forcerange="-9000 9000"': 'forcerange="-90000 70000"',
    'kp="144000.0"': 'kp="3e8"',
    'range="-1 2"': 'range="-12.6 12.6"',
}


def changed(text: str, changes: dict[str, str]) -> str:
    for old, new in changes.items():
        assert old in text, old
        text = text.replace(old, new)
    return text


def robot_of(folder: Path, mjcf: str) -> Path:
    write_small_robot(folder)
    (folder / "small.xml").write_text(mjcf)
    return folder


@pytest.mark.parametrize("name", robot_names())
def test_robots_that_come_along_are_plausible(name: str) -> None:
    robot = load_robot(name)
    model = compile_robot(robot).model
    assert [*implausible(model), *unlike_a_robot(robot, model)] == []


@pytest.mark.parametrize("changes", [DESKTOP, TITAN], ids=["desktop", "titan"])
def test_small_and_large_robots_are_robots(changes: dict[str, str], tmp_path: Path) -> None:
    assert compile_robot(load_robot(robot_of(tmp_path / "robot", changed(MJCF, changes)))).n_joints == 2


def test_a_desktop_arm_can_be_started(tmp_path: Path) -> None:
    text = stranger.mjcf(damping="0.001", armature=1e-6)
    for mass, inertia in zip(stranger.MASS, stranger.INERTIA, strict=True):
        text = text.replace(f'mass="{mass}"', 'mass="0.05"')
        text = text.replace(f'diaginertia="{" ".join(f"{x:g}" for x in inertia)}"', 'diaginertia="1e-5 1e-5 1e-5"')
    for limit in stranger.LIMIT:
        text = text.replace(f'forcerange="{-limit} {limit}"', 'forcerange="-1.5 1.5"')
    (tmp_path / "arm.xml").write_text(text)
    assert start_robot("arm", read_source(tmp_path / "arm.xml"), tmp_path / "arm").compiled.n_joints == 3


def test_all_faults_of_a_model_are_told_with_their_places(tmp_path: Path) -> None:
    slips = {'armature="40.0"': 'armature="-2"', 'mass="40.0"': 'mass="40000"', 'timestep="0.001"': 'timestep="0"'}
    with pytest.raises(RobotError) as caught:
        compile_robot(load_robot(robot_of(tmp_path / "robot", changed(MJCF, slips))))
    problems = caught.value.problems
    assert len(problems) == 3
    assert all("small.xml: " in problem for problem in problems)
    for place in ("<option>: timestep is 0 s", "body 'upper': mass is 40000 kg", "joint 'rotor_a': armature is -2"):
        assert any(place in problem for problem in problems)


def test_a_slip_at_every_joint_does_not_fill_the_page(tmp_path: Path) -> None:
    bodies = '<body pos="900 0 0"/>' * 50
    with pytest.raises(RobotError) as caught:
        compile_robot(load_robot(robot_of(tmp_path / "robot", MJCF.replace("<worldbody>", f"<worldbody>{bodies}"))))
    assert len(caught.value.problems) == MOST_TOLD


def test_open_ends_of_ranges_are_none() -> None:
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body><joint limited="true" range="-inf inf"/><geom size="0.1"/></body></worldbody>'
        "</mujoco>"
    )
    assert list(implausible(model)) == []


def figures_with(key: str, value: float) -> dict[str, object]:
    """Return figures of the small robot with one changed: `key` as the table of models/README.md has it."""
    content = yaml.safe_load(yaml.safe_dump(FIGURES))
    content["instruments"] |= {"torque": {"sigma_nm": 1.0}, "link_encoder": {"joints": ["hinge_a"]}}
    place = content["drives"][0] if key.startswith("drives[]") else content
    *sections, last = key.removeprefix("drives[].").split(".")
    for section in sections:
        place = place.setdefault(section, {})
    place[last] = [value] * 3 if last == "position_m" else value
    return dict(content)


KEYS = [
    (f"{place}.{name}", schema)
    for place, kind in PARTS
    for name, schema in kind.model_json_schema()["properties"].items()
    if schema.get("type") not in ("string", "array") or name == "position_m"
]


@pytest.mark.parametrize("key", [key for key, schema in KEYS if "joints" not in key])
def test_every_figure_has_a_most(key: str) -> None:
    assert Figures.model_validate(figures_with(key, 1.0 if key == "uncertainty.links" else 0.05))
    with pytest.raises(ValueError, match=key.split(".")[-1]):
        Figures.model_validate(figures_with(key, 1e9 + 1 if key.endswith("_pa") else 2e7))


def test_of_what_bends_the_sign_alone_counts() -> None:
    """A handed-over robot holds stiff hinges in its links, with armature and damping beyond those of any drive."""
    text = (
        '<mujoco><worldbody><body><joint name="bends" stiffness="1e12" damping="{}" armature="4e6"/>'
        '<geom size="0.1"/></body></worldbody></mujoco>'
    )
    assert list(implausible(mujoco.MjModel.from_xml_string(text.format("2e9")))) == []
    (fault,) = implausible(mujoco.MjModel.from_xml_string(text.format("-2e9")))
    assert "joint 'bends': damping is -2e+09" in fault


HINDERED = {
    "gear": ('forcerange="-9000 9000"', 'forcerange="-9000 9000" gear="2"', 'servo_a\' has gear="2"'),
    "posrange": ('forcerange="-9000 9000"', 'forcerange="-9000 9000" posrange="-0.5 0.5"', "posrange is"),
    "torque": ('range="-1 2"', 'range="-1 2" actuatorfrcrange="-1 1"', "'hinge_a' has actuatorfrcrange"),
    "friction": ('range="-1 2"', 'range="-1 2" frictionloss="9500"', "Coulomb friction of motor"),
    "mass": ('angle="radian"', 'angle="radian" boundmass="30"', "boundmass raises the mass of body"),
    "inertia": ('angle="radian"', 'angle="radian" boundinertia="0.5"', "boundinertia raises the inertia of body"),
}


@pytest.mark.parametrize(("old", "new", "words"), HINDERED.values(), ids=HINDERED)
def test_nothing_stands_between_a_drive_and_its_joint(tmp_path: Path, old: str, new: str, words: str) -> None:
    with pytest.raises(RobotError, match=words):
        compile_robot(load_robot(robot_of(tmp_path / "robot", MJCF.replace(old, new))))


@pytest.mark.parametrize(("angle", "are_told"), [("degree", True), ("radian", False)])
def test_ranges_in_radians_are_no_degrees(angle: str, are_told: bool) -> None:
    """A UR5e whose `<compiler angle="radian">` was lost could turn by 13 degrees, and nothing was said."""
    body = '<body><joint range="-6.28319 6.28319"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>'
    joints = 3 * body
    text = f'<mujoco><compiler angle="{angle}" autolimits="true"/><worldbody>{joints}</worldbody></mujoco>'
    said = [words for words in implausible(mujoco.MjModel.from_xml_string(text)) if "widest range" in words]
    assert bool(said) == are_told
    assert all("12.6 degrees" in words and "radian" in words for words in said)


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ('mass="25.0"', 'mass="1e-12"', "body 'fore': mass is 1e-12 kg"),
        ('key="presliding_stiffness" value="4e5"', 'key="presliding_stiffness" value="1e300"', "is 1e+300 Nm/rad"),
        ('key="presliding_stiffness" value="4e5"', 'key="presliding_stiffness" value="1e-300"', "is 1e-300 Nm/rad"),
    ],
)
def test_what_hardly_weighs_or_never_or_at_once_slides_is_no_robot(
    old: str, new: str, place: str, tmp_path: Path
) -> None:
    """They were believed."""
    with pytest.raises(RobotError) as caught:
        compile_robot(load_robot(robot_of(tmp_path / "robot", changed(MJCF, {old: new}))))
    assert place in str(caught.value)
    assert "small.xml: " in str(caught.value)


def test_friction_that_a_diagnosis_took_away_holds_as_it_did(tmp_path: Path) -> None:
    gone = changed(MJCF, {'key="coulomb" value="60.0"': 'key="coulomb" value="1e-9"'})
    assert compile_robot(load_robot(robot_of(tmp_path / "robot", gone))).motor_presliding[0] == 4e5


@pytest.mark.parametrize(
    ("key", "value", "sound"),
    [
        ("nest_m.nest_1", [5, 0, 0], [0.3, 0, 0]),
        ("current_offset_a.hinge_b", 200.0, 60.0),
        ("torque_offset_nm.hinge_a", -2e4, -6e3),
        ("tracker_drift_m_per_h", [0, 0, 4], [0, 0, 0.01]),
    ],
)
def test_errors_of_readings_that_no_instrument_has(key: str, value: object, sound: object, tmp_path: Path) -> None:
    """A reflector that sits five metres beside its nest was believed."""
    for number, given in enumerate((sound, value)):
        write_small_robot(tmp_path / str(number))
        name, *rest = key.split(".")
        content = yaml.safe_load(yaml.safe_dump(FIGURES))
        content["fitted"] = {"readings": {name: {rest[0]: given} if rest else given}}
        (tmp_path / str(number) / "figures.yaml").write_text(yaml.safe_dump(content))
    assert compile_robot(load_robot(tmp_path / "0")).n_joints == 2
    with pytest.raises(RobotError, match=f"figures.yaml: fitted.readings.{key}: is "):
        compile_robot(load_robot(tmp_path / "1"))


@pytest.mark.parametrize("number", ["0x384", "9OO", "1_000"])
def test_an_attribute_that_is_no_number_has_file_and_line(number: str, tmp_path: Path) -> None:
    """The engine takes hexadecimal numbers, and what does not take them said neither file nor line."""
    text = changed(MJCF, {'key="constant" value="900.0"': f'key="constant" value="{number}"'})
    (line,) = [k for k, words in enumerate(text.splitlines(), start=1) if number in words]
    with pytest.raises(RobotError, match=f"small.xml: line {line}: constant is {number!r}, which is no number"):
        compile_robot(load_robot(robot_of(tmp_path / "robot", text)))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("", "", r"figures.yaml: counterbalance.joint: is 'hinge_b', but the cylinder's tendon runs across 'hinge_a';"),
        (
            '<site site="anchor_a"/><site site="anchor_b"/>',
            '<site site="anchor_a"/><site site="hook"/>',
            "counterbalance.joint: is 'hinge_a', but the cylinder's tendon runs across 'hinge_a' and 'hinge_b'",
        ),
        (
            '<site site="anchor_a"/><site site="anchor_b"/>',
            '<site site="anchor_b"/><site site="anchor_a"/>',
            "counterbalance.tendon: runs from the moving side of 'hinge_a' to the fixed one",
        ),
    ],
)
def test_a_cylinder_that_is_not_across_its_joint_is_told_at_the_key(
    old: str, new: str, words: str, tmp_path: Path
) -> None:
    """`bench check` said that the nominal model cannot follow the motion, and to look at angles."""
    folder = robot_of(tmp_path / "robot", changed(MJCF, {old: new}) if old else MJCF)
    content = yaml.safe_load(yaml.safe_dump(FIGURES))
    content["counterbalance"]["joint"] = "hinge_a" if old else "hinge_b"
    (folder / "figures.yaml").write_text(yaml.safe_dump(content))
    with pytest.raises(RobotError, match=words):
        compile_robot(load_robot(folder))
