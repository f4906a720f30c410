"""A robot written as a new folder compiles to the same model, with every file that it names."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from bench.robot.compiled import compile_robot, read_spec
from bench.robot.folder import FIGURES_FILE, load_robot, robot_names
from bench.robot.write import write_robot
from bench.robot.xml import DIGITS, xml_of
from tests.small_robot import MJCF, write_small_robot

ROUNDING = 10.0 ** (2 - DIGITS)  # relative, of numbers written to 15 digits, after what the compiler makes of them
TETRAHEDRON = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
SCENE = '<mujoco><include file="small.xml"/><asset><mesh file="{}"/></asset></mujoco>'


@pytest.mark.parametrize("name", robot_names())
def test_the_models_come_out_as_they_went_in(name: str, tmp_path: Path) -> None:
    robot = load_robot(name)
    spec = read_spec(robot)
    spec.compile()
    write_robot(robot, spec, robot.figures, tmp_path, "# Written\n")
    again = load_robot(tmp_path)
    assert again.figures == robot.figures
    before, after = compile_robot(robot).model, compile_robot(again).model
    compared = 0
    for attribute in dir(before):
        values = getattr(before, attribute)
        if isinstance(values, np.ndarray) and values.dtype == np.float64 and values.size:
            scale = max(1.0, float(np.max(np.abs(values))))
            np.testing.assert_allclose(
                getattr(after, attribute), values, rtol=0, atol=ROUNDING * scale, err_msg=attribute
            )
            compared += 1
    assert compared > 50
    scene = robot.figures.scene
    assert scene
    assert mujoco.MjModel.from_xml_path(str(tmp_path / scene)).nv == before.nv
    assert (tmp_path / "log.yaml").is_file() == (robot.folder / "log.yaml").is_file()


def robot_with_mesh(folder: Path, scene: str) -> Path:
    """Write the two-joint robot with a mesh in a folder of its own, and a scene."""
    write_small_robot(folder)
    mesh = '<compiler angle="radian" meshdir="shapes"/><asset><mesh name="tip" file="deep/tip.obj"/></asset>'
    geom = '<geom type="mesh" mesh="tip" contype="0" conaffinity="0"/><site name="hook"'
    text = MJCF.replace('<compiler angle="radian"/>', mesh).replace('<site name="hook"', geom)
    (folder / "small.xml").write_text(text)
    for place in (folder / "shapes" / "deep" / "tip.obj", folder / "shapes" / "floor.obj"):
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(TETRAHEDRON)
    (folder / "scene.xml").write_text(scene)
    (folder / FIGURES_FILE).write_text((folder / FIGURES_FILE).read_text() + "scene: scene.xml\n")
    return folder


@pytest.mark.parametrize("names_more", [False, True])
def test_meshes_come_along_and_the_scene_still_shows_the_robot(tmp_path: Path, names_more: bool) -> None:
    scene = SCENE.format("floor.obj") if names_more else SCENE.format("deep/tip.obj").replace("<mesh", '<mesh name="x"')
    robot = load_robot(robot_with_mesh(tmp_path / "from", scene))
    spec = read_spec(robot)
    spec.compile()
    (tmp_path / "to").mkdir()
    write_robot(robot, spec, robot.figures, tmp_path / "to", "")
    (tmp_path / "from").rename(tmp_path / "gone")
    assert compile_robot(load_robot(tmp_path / "to")).model.nmesh == 1
    shown = mujoco.MjModel.from_xml_path(str(tmp_path / "to" / "scene.xml"))
    assert shown.nmesh == (1 if names_more else 2)  # a scene with meshes of its own is replaced by a plain one
    assert shown.nu == compile_robot(load_robot(tmp_path / "to")).model.nu


def test_numbers_have_fifteen_digits_and_mujoco_keeps_its_own(tmp_path: Path) -> None:
    robot = load_robot(write_small_robot(tmp_path))
    spec = read_spec(robot)
    spec.body("upper").mass = 40.0 + 1 / 3
    spec.compile()
    assert 'mass="40.3333333333333"' in xml_of(spec)
    assert 'mass="40.3333"' in spec.to_xml()
