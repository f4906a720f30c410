"""Robots of strangers: nothing in their files ends, hangs or fills the process that reads them."""

import os
from pathlib import Path

import pytest

from bench.errors import RobotError
from bench.record.limits import MODEL_COPIES, MODEL_DEPTH, MODEL_ELEMENTS, MODEL_INCLUDES, MODEL_SECONDS
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.starter.source import read_source
from tests.small_robot import MJCF, write_small_robot

TABLE = (
    '<plugin name="drag" joint="hinge_a" plugin="bench.torque_table"><config key="angle_min" value="0"/>'
    '<config key="angle_max" value="{top}"/><config key="forward" value="{torques}"/>'
    '<config key="backward" value="{torques}"/></plugin>'
)
WITH_TABLES = MJCF.replace("<extension>", '<extension><plugin plugin="bench.torque_table"/>')
CROWD = '<replicate count="1900"><body><geom size="1"/></body></replicate>'
ABYSS = "<body>" * 5000 + "</body>" * 5000


def with_table(top: str, torques: str = "1 2") -> str:
    return WITH_TABLES.replace("</actuator>", TABLE.format(top=top, torques=torques) + "</actuator>")


def robot_of(tmp_path: Path, mjcf: str) -> Path:
    folder = write_small_robot(tmp_path / "robot")
    (folder / "small.xml").write_text(mjcf)
    return folder


def refused(folder: Path) -> str:
    with pytest.raises(RobotError) as caught:
        compile_robot(load_robot(folder))
    return str(caught.value)


FAULTS = {
    "a table of no width": (with_table("1e-310"), "angle_max"),
    "a table that is too wide": (with_table("1.7e308").replace('value="0"', 'value="-1.7e308"'), "angle_max"),
    "torques whose sum is infinite": (with_table("1", "1.7e308 1.7e308"), "forward"),
    "a keyframe that is no number": (
        MJCF.replace("</mujoco>", '<keyframe><key qpos="0 nan 0 0"/></keyframe></mujoco>'), "<key>: qpos holds nan"
    ),
    "ten thousand million copies": (
        MJCF.replace("<worldbody>", '<worldbody><replicate count="100000"><replicate count="100000"><site/>'
        "</replicate></replicate>"),
        f"makes more than {MODEL_COPIES}",
    ),
    "copies in the child": (
        MJCF.replace("<worldbody>", f"<worldbody>{CROWD * 40}"),
        "not done|memory|alloc",
    ),
    "a very deep tree": (MJCF.replace("<worldbody>", f"<worldbody>{ABYSS}"), f"more than {MODEL_DEPTH}"),
    "as many keyframes": (
        MJCF.replace("</mujoco>", f"<keyframe>{'<key/>' * 20_000}</keyframe></mujoco>"), f"more than {MODEL_ELEMENTS}"
    ),
    "entities": ('<!DOCTYPE a [<!ENTITY b "c">]>' + MJCF, "line 1: has a document type"),
    "not XML": (MJCF.replace("</worldbody>", "</worldbod>"), "not XML"),
    "memory": (MJCF.replace("<worldbody>", '<size nuserdata="2000000000"/><worldbody>'), "memory|alloc"),
    "sensors without end": (
        MJCF.replace("<worldbody>", '<sensor><user dim="20000000"/></sensor><worldbody>'), "hold 20000000 numbers, more"
    ),
    "a mesh that is endless": (
        MJCF.replace("<worldbody>", '<asset><mesh name="m" file="endless.stl"/></asset><worldbody>'), "is a device"
    ),
    "a mesh that is a pipe": (
        MJCF.replace("<worldbody>", '<asset><mesh name="m" file="pipe.stl"/></asset><worldbody>'), "is a named pipe"
    ),
}  # fmt: skip


@pytest.mark.parametrize(("mjcf", "words"), FAULTS.values(), ids=FAULTS)
def test_what_would_crash_or_hang_is_one_sentence(
    mjcf: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(MODEL_SECONDS.variable, "2")
    folder = robot_of(tmp_path, mjcf)
    os.mkfifo(folder / "pipe.stl")
    (folder / "endless.stl").symlink_to("/dev/zero")
    said = refused(folder)
    assert any(word in said for word in words.split("|")), said
    assert "small.xml" in said or ".stl" in said


def test_includes_are_counted(tmp_path: Path) -> None:
    folder = robot_of(tmp_path, MJCF.replace("<worldbody>", '<include file="0.xml"/><worldbody>'))
    for i in range(3000):
        (folder / f"{i}.xml").write_text(f'<mujoco><include file="{i + 1}.xml"/></mujoco>')
    (folder / "3000.xml").write_text("<mujoco/>")
    assert f"more than {MODEL_INCLUDES}" in refused(folder)


def test_a_file_that_includes_itself_is_named(tmp_path: Path) -> None:
    folder = robot_of(tmp_path, MJCF.replace("<worldbody>", '<include file="small.xml"/><worldbody>'))
    assert "small.xml" in refused(folder)


def test_a_reader_that_dies_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the look at the text does not know still cannot end the process."""
    monkeypatch.setenv(MODEL_INCLUDES.variable, "100000")
    monkeypatch.setattr("bench.robot.trial.look_through", lambda file: None)
    folder = robot_of(tmp_path, MJCF.replace("<worldbody>", '<include file="0.xml"/><worldbody>'))
    for i in range(3000):
        (folder / f"{i}.xml").write_text(f'<mujoco><include file="{i + 1}.xml"/></mujoco>')
    (folder / "3000.xml").write_text("<mujoco/>")
    assert "MuJoCo's reader died of it (SIGSEGV)" in refused(folder)


def test_somebody_elses_model_is_tried_too(tmp_path: Path) -> None:
    file = tmp_path / "arm.xml"
    file.write_text(FAULTS["a very deep tree"][0])
    with pytest.raises(RobotError, match="more than"):
        read_source(file)


def test_a_sound_robot_passes_and_limits_can_be_raised(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = robot_of(tmp_path, MJCF.replace("<worldbody>", '<worldbody><replicate count="2500"><site/></replicate>'))
    assert "BENCH_MOST_MODEL_COPIES" in refused(folder)
    monkeypatch.setenv("BENCH_MOST_MODEL_COPIES", "2500")
    assert compile_robot(load_robot(folder)).n_joints == 2


def test_figures_are_read_once_and_not_guessed(tmp_path: Path) -> None:
    folder = robot_of(tmp_path, MJCF)
    text = (folder / "figures.yaml").read_text()
    (folder / "figures.yaml").write_text(text + "title: another\n")
    assert "'title' occurs twice" in refused(folder)


@pytest.mark.parametrize(
    ("fitted", "words"),
    [
        ("{readings: {torque_gain: {hinge_a: 1e300}}}", r"fitted.readings.torque_gain.hinge_a: .*equal to 10"),
        ("{effects: [{effect: gas_loss, values: {lost: 1e300}}]}", r"values.lost: 1e\+300 is no figure of a robot"),
    ],
)
def test_figures_of_no_robot_are_named(tmp_path: Path, fitted: str, words: str) -> None:
    folder = write_small_robot(tmp_path / "robot")
    text = (folder / "figures.yaml").read_text()
    (folder / "figures.yaml").write_text(f"{text}\nfitted: {fitted}\n")
    with pytest.raises(RobotError, match=words):
        load_robot(folder)
