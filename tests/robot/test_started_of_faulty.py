"""`bench new-robot` on files that cannot be: a sentence that names the user's file, not the folder in the making."""

from pathlib import Path

import pytest
import yaml

from bench.cli import main
from bench.errors import RobotError
from bench.robot.folder import load_robot
from bench.robot.starter.folder import Started, start_robot
from bench.robot.starter.source import read_source
from tests import stranger

MJCF, URDF = stranger.mjcf(), stranger.urdf()
LIMIT = '<limit lower="-2" upper="2" effort="120" velocity="1.7"/>'
JOINT = 'name="j1" axis="0 0 1" range="-2.6 2.6"'
# Of the MJCF
SLIPS = {
    "a rotor of 1e20": ('armature="1.2"', 'armature="1e20"', "joint 'j1': armature is 1e+20"),
    "a rotor of next to nothing": ('armature="1.2"', 'armature="1e-310"', "actuator 'j1_servo': kp is"),
    "a rotor below zero": ('armature="1.2"', 'armature="-0.01"', "joint 'j1': armature is -0.01"),
    "damping below zero": ('damping="350"', 'damping="-1"', "joint 'j1': damping is -1"),
    "degrees for radians": (JOINT, JOINT.replace("-2.6 2.6", "-150 150"), "joint 'j1': range is -150 rad"),
    "limits exchanged": (JOINT, JOINT.replace("-2.6 2.6", "2.6 -2.6"), "joint 'j1': range is \"2.6 -2.6\"; exchange"),
    "torque limits exchanged": (
        'forcerange="-200.0 200.0"',
        'forcerange="200 -200"',
        'forcerange is "200 -200"; exchange',
    ),
    "a spring that pushes away": (JOINT, f'{JOINT} stiffness="-5"', "joint 'j1': stiffness is -5 Nm/rad"),
    "a drive that pulls one way": (
        'forcerange="-200.0 200.0"',
        'forcerange="-200 0"',
        "joint 'j1': forcerange of its actuator is \"-200 0\"",
    ),
    "a drive that never rests": ('forcerange="-200.0 200.0"', 'forcerange="10 200"', "a drive pulls both ways"),
    "an axis beyond numbers": (JOINT, JOINT.replace("0 0 1", "1e300 1e300 0"), "joint 'j1': length of its axis"),
    "a centre of mass in millimetres": (
        'mass="12.0" pos="',
        'mass="12.0" pos="250',
        "distance of its centre of mass is",
    ),
    "grams for kilograms": ('mass="12.0"', 'mass="12000"', "body 'l1': mass is 12000 kg"),
    "an endless torque limit": ('forcerange="-200.0 200.0"', 'forcerange="-1e20 1e20"', "forcerange is -1e+20"),
    "a rotor's name": ('name="l1"', 'name="j1_rotor"', "body 'j1_rotor': a part that is added"),
    "a joint with a rotor's name": ("j3", "j1_rotor", "joint 'j1_rotor': a part that is added"),
    "the load point's name": ('name="attachment_site"', 'name="bench_load_point"', "site 'bench_load_point'"),
    "a line break in a name": ("j1", "j&#10;1", r"line 1: <joint>: name 'j\n1' has a line break"),
    "a line break in a body's name": ("l3", "l&#10;3", r"line 1: <body>: name 'l\n3' has a line break"),
}
OF_URDF = {
    "effort below zero": (LIMIT, LIMIT.replace("120", "-150"), "joint 'shoulder': limit: effort is -150"),
    "speed below zero": (LIMIT, LIMIT.replace("1.7", "-2"), "joint 'shoulder': limit: velocity is -2"),
    "a speed in words": (LIMIT, LIMIT.replace("1.7", "fast"), "joint 'shoulder': limit: velocity is 'fast', no number"),
    "an effort in hexadecimal": (LIMIT, LIMIT.replace("120", "0x3"), "joint 'shoulder': limit: effort is '0x3', no n"),
    "limits exchanged": (LIMIT, LIMIT.replace("-2", "2", 1).replace('upper="2"', 'upper="-2"'), "lower is 2, above"),
    "angles of an origin in degrees": (
        '<origin xyz="0 0 0.4"/>',
        '<origin xyz="0 0 0.4" rpy="0 -90 0"/>',
        "joint 'elbow': origin: rpy is '0 -90 0', more than a whole turn",
    ),
    "two joints of one name": ('name="elbow"', 'name="shoulder"', "2 joints have the name 'shoulder'"),
    "a rotor below zero": ('damping="1.5"', 'damping="-1"', "joint 'shoulder': damping is -1"),
    "an include of xacro": (
        '<robot name="other">',
        '<robot name="other" xmlns:xacro="http://ros.org/wiki/xacro"><xacro:include filename="y.xacro"/>',
        "line 2: <xacro:include> is for xacro",
    ),
    "a macro of xacro": ('<mass value="6"/>', '<mass value="${m}"/>', "value holds '${m}', which is for xacro"),
    "a prefix that stands for nothing": ("</robot>", "<gz:x/></robot>", "not XML (unbound prefix"),
}
CASES = {name: (MJCF, "arm.xml", *case) for name, case in SLIPS.items()} | {
    f"URDF: {name}": (URDF, "arm.urdf", *case) for name, case in OF_URDF.items()
}


def started(folder: Path, text: str, name: str = "arm.xml", joints: tuple[str, ...] = ()) -> Started:
    (folder / name).write_text(text)
    return start_robot("arm", read_source(folder / name, joints), folder / "arm")


@pytest.mark.parametrize(("text", "file", "old", "new", "said"), CASES.values(), ids=CASES)
def test_what_cannot_be_is_said_of_the_file(
    text: str, file: str, old: str, new: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert old in text
    (tmp_path / file).write_text(text.replace(old, new))
    assert (
        main(["new-robot", "arm", "--mjcf", str(tmp_path / file), "-o", str(tmp_path / "arm")]) == RobotError.exit_code
    )
    words = " ".join(capsys.readouterr().err.split())
    assert said in words
    assert f"{tmp_path / file}: " in words
    assert f"{tmp_path / file}: {tmp_path / file}" not in words, "each fault names it once"
    assert "partial" not in words
    assert not (tmp_path / "arm").exists()


def test_a_joint_that_is_named_twice(tmp_path: Path) -> None:
    with pytest.raises(RobotError, match="--joints: j1 j1 names a joint twice"):
        started(tmp_path, MJCF, joints=("j1", "j1"))


ODD = ("\N{ROBOT FACE}", "j: \N{MECHANICAL ARM}#")  # JSON has such characters as pairs of halves, which YAML refuses


@pytest.mark.parametrize(
    "name", ["yes", "null", "1", "1e3", "2024-99-99", 'j"1', "j: #1", "a/b", "Gelenk ü", "-", "~", *ODD]
)
def test_every_name_of_a_line_is_a_name(name: str, tmp_path: Path) -> None:
    written = name.replace('"', "&quot;")
    drive = started(tmp_path, MJCF.replace('"j1"', f'"{written}"')).compiled.robot.figures.drives[0]
    assert (drive.joint, drive.rotor) == (name, f"{name}_rotor")
    figures = load_robot(tmp_path / "arm").figures
    assert figures.drives[0].joint == name
    assert any(name in line for line in figures.assumed)


@pytest.mark.parametrize("encoding", ["gb2312", "Shift_JIS", "UTF-32", "utf-7", "ISO-8859-1", "hex", "nope"])
def test_a_file_is_read_as_utf_8_whatever_it_declares(encoding: str, tmp_path: Path) -> None:
    """As MuJoCo reads it. Others ended in "multi-byte encodings are not supported", or names in two bytes a letter."""
    text = URDF[URDF.index("<robot") :].replace('"shoulder"', '"Gelenk ü"')
    (tmp_path / "arm.urdf").write_text(f'<?xml version="1.0" encoding="{encoding}"?>\n{text}', encoding="utf-8")
    found = start_robot("arm", read_source(tmp_path / "arm.urdf"), tmp_path / "arm")
    assert "Gelenk ü" in [drive.joint for drive in found.compiled.robot.figures.drives]


def test_a_namespace_changes_nothing(tmp_path: Path) -> None:
    """Speed limits were "none" then, and the load point lay elsewhere; an effort of -1200 Nm was taken."""
    found = []
    for name, text in (("plain", URDF), ("named", URDF.replace("<robot ", '<robot xmlns="http://www.ros.org" '))):
        (tmp_path / f"{name}.urdf").write_text(text)
        found.append(start_robot("arm", read_source(tmp_path / f"{name}.urdf"), tmp_path / name))
    plain, named = (one.compiled.robot.figures for one in found)
    assert [drive.speed_limit_rad_per_s for drive in named.drives] == [d.speed_limit_rad_per_s for d in plain.drives]
    assert named.assumed == plain.assumed


def test_a_speed_limit_in_degrees_is_said(tmp_path: Path) -> None:
    """It was "the file", and torques and damping were judged by a joint that turns 24 times a second."""
    fast = URDF.replace('velocity="1.7"', 'velocity="150"')
    assert fast != URDF
    (tmp_path / "arm.urdf").write_text(fast)
    figures = start_robot("arm", read_source(tmp_path / "arm.urdf"), tmp_path / "arm").compiled.robot.figures
    said = [line for line in figures.assumed if line.startswith("speed limit (shoulder 150")]
    assert len(said) == 1
    assert "degrees per second" in said[0]


def test_names_that_are_made_up_are_said(tmp_path: Path) -> None:
    text = stranger.mjcf(actuators=False).replace('name="j3" ', "").replace('name="j1"', 'name="joint3"')
    figures = started(tmp_path, text).compiled.robot.figures
    assert [drive.joint for drive in figures.drives] == ["joint3", "j2", "joint3_unnamed"]
    assert "name of joint3_unnamed: the file has none" in figures.assumed
    assert yaml.safe_load((tmp_path / "arm" / "figures.yaml").read_text())["assumed"] == list(figures.assumed)


def test_a_range_without_ends_is_none(tmp_path: Path) -> None:
    """It was written down, for the servo as well, and not among what was assumed."""
    (tmp_path / "arm.xml").write_text(MJCF.replace(JOINT, JOINT.replace("-2.6 2.6", "-inf inf")))
    started = start_robot("arm", read_source(tmp_path / "arm.xml"), tmp_path / "arm")
    assert any(line.startswith("range (j1 -360 to 360 degrees)") for line in started.compiled.robot.figures.assumed)
