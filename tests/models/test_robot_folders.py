"""Rules that hold for every robot folder in models/."""

import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yaml

from bench.robot.figures import Figures

MODELS = Path(__file__).parents[2] / "models"
ROBOTS = sorted(path.parent for path in MODELS.glob("*/figures.yaml"))
ORDER = ["compiler", "option", "extension", "default", "asset", "worldbody", "tendon", "actuator", "sensor", "keyframe"]
WIDTH = 120

robots = pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)


def figures_of(robot: Path) -> Figures:
    return Figures.model_validate(yaml.safe_load((robot / "figures.yaml").read_text()))


def model_of(robot: Path) -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_path(str(robot / figures_of(robot).mjcf))


@robots
def test_folder_is_complete(robot: Path) -> None:
    figures = figures_of(robot)
    assert figures.mjcf == f"{robot.name}.xml"
    assert figures.scene == "scene.xml"
    assert (robot / "README.md").is_file()
    included = ElementTree.parse(robot / "scene.xml").getroot().find("include")
    assert included is not None
    assert included.get("file") == figures.mjcf


@robots
def test_elements_stand_in_order(robot: Path) -> None:
    root = ElementTree.parse(robot / f"{robot.name}.xml").getroot()
    tags = [child.tag for child in root]
    assert tags == [tag for tag in ORDER if tag in tags]
    assert root.get("model") == robot.name
    assert [key.get("name") for key in root.iter("key")] == ["home"]


@robots
def test_layout_of_the_text(robot: Path) -> None:
    for file in (robot / f"{robot.name}.xml", robot / "scene.xml", robot / "figures.yaml"):
        for number, line in enumerate(file.read_text().splitlines(), start=1):
            place = f"{file.name}:{number}"
            assert len(line) <= WIDTH, place
            assert line == line.rstrip(), place
            assert "\t" not in line, place
            indent = len(line) - len(line.lstrip())
            assert indent % 2 == 0 or re.match(r"\s+[a-zA-Z]", line), f"{place}: indent by two spaces"


@robots
def test_names_of_the_figures_exist(robot: Path) -> None:
    figures, model = figures_of(robot), model_of(robot)
    for drive in figures.drives:
        link, rotor, element = model.joint(drive.joint), model.joint(drive.rotor), model.tendon(drive.element).id
        wrapped = slice(model.tendon_adr[element], model.tendon_adr[element] + model.tendon_num[element])
        coefficients = dict(zip(model.wrap_objid[wrapped].tolist(), model.wrap_prm[wrapped].tolist(), strict=True))
        assert coefficients == {rotor.id: 1.0, link.id: -1.0}, drive.element
        assert model.actuator(drive.servo).trnid[0] == rotor.id
        assert model.actuator(drive.motor_friction).trnid[0] == rotor.id
        assert model.actuator(drive.link_friction).trnid[0] == link.id
        assert model.jnt_limited[link.id]
    for site in (figures.load_point, *figures.reflectors):
        model.site(site)
    if figures.counterbalance:
        model.joint(figures.counterbalance.joint)
        assert (
            model.actuator(figures.counterbalance.actuator).trnid[0] == model.tendon(figures.counterbalance.tendon).id
        )


@robots
def test_load_body_is_massless_and_at_the_load_point(robot: Path) -> None:
    figures, model = figures_of(robot), model_of(robot)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    body = model.body(figures.load_body)
    assert body.mass[0] == 0
    assert body.jntnum[0] == body.geomnum[0] == 0
    np.testing.assert_allclose(data.body(body.id).xipos, data.site(figures.load_point).xpos, atol=1e-12)


@robots
def test_scene_opens_without_this_package_being_imported(robot: Path, tmp_path: Path) -> None:
    """The entry point of the installed package registers the plugins; the viewer needs no more than this."""
    probe = "import sys, mujoco; print(mujoco.MjModel.from_xml_path(sys.argv[1]).nv)"
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", probe, str(robot / "scene.xml")],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) == 2 * len(figures_of(robot).drives)


@robots
def test_option(robot: Path) -> None:
    model = model_of(robot)
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    assert model.opt.timestep <= 1e-3
