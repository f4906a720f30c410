"""The page on what to do with the result of a diagnosis: its code and its commands run, and say what the page says."""

import re
import shlex
import shutil
import subprocess
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yaml

import bench.report.handover
from bench.cli import main
from bench.report.diagnosis.words import places_of
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.found import write_found
from tests.small_robot import FIGURES, MJCF, ROTOR, write_small_robot

README = (Path(bench.report.handover.__file__).parent / "README.md").read_text(encoding="utf-8")
OWN = MJCF.replace("<worldbody>", '<worldbody><geom name="floor" type="plane" size="3 3 0.1" pos="0 0 -2"/>')
PINOCCHIO = 1e-9  # as the page says, of the largest torque
MEDIAN, SLIDING = 5e-3, 0.04  # as the page says
CURRENT_ERROR_A = 0.08  # three standard deviations of what instruments draw: offset 0.01, noise 0.02, 1.1 % of 1 A
SETTLED_S = 0.5


def sliding(mjcf: str) -> str:
    """Return the MJCF with a second joint that is a slide, in and out along its link, and servos as soft as 3 Hz."""
    slide = 'type="slide" axis="1 0 0"'
    changes = {
        '"hinge_b" axis="0 1 0" range="-2 2"': f'"hinge_b" {slide} range="-0.1 0.3"',
        '"rotor_b" axis="0 1 0"': f'"rotor_b" {slide}',
        **{
            f'kp="{j * 3600}" kv="{j * 120}" ki="{j * 36000}"': f'kp="{j * 360}" kv="{j * 38}" ki="{j * 1140}"'
            for j in ROTOR
        },
    }
    for old, new in changes.items():
        assert old in mjcf
        mjcf = mjcf.replace(old, new)
    return mjcf


@pytest.fixture(scope="module", params=["hinges", "a slide"])
def place(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder as the page takes it for granted: with `found`, of a robot whose MJCF is named hh150.xml."""
    place = tmp_path_factory.mktemp("page")
    robot = write_small_robot(place / "hh150")
    (robot / "small.xml").unlink()
    made = sliding if request.param == "a slide" else str
    (robot / "hh150.xml").write_text(made(MJCF))
    (robot / "figures.yaml").write_text(yaml.safe_dump(FIGURES | {"mjcf": "hh150.xml"}))
    write_found(robot, place / "found", start_deg=[-30, 0])
    (place / "mine.xml").write_text(made(OWN))
    return place


@pytest.fixture(scope="module")
def ran(place: Path) -> dict[str, object]:
    """Run the page, and return the names that its Python code leaves."""
    names: dict[str, object] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        for kind, code in re.findall(r"```(python|sh)\n(.*?)```", README, re.DOTALL):
            if kind == "python":
                exec(compile(code, "README.md", "exec"), names)
                continue
            for line in code.splitlines():
                words = shlex.split(line)
                if words[0] == "bench":
                    assert main(words[1:]) == 0
                elif shutil.which(words[0]):
                    subprocess.run(words, check=True, capture_output=True)
    return names


def test_pinocchio_agrees_with_the_table(ran: dict[str, object]) -> None:
    rigid, links, rotor = (np.asarray(ran[name]) for name in ("rigid", "links", "rotor"))
    np.testing.assert_allclose(rigid[1:-1], (links + rotor)[1:-1], atol=PINOCCHIO * np.abs(rigid).max())
    assert np.abs(rigid).max() > 50


def test_steps_in_time_agree_with_the_table(ran: dict[str, object]) -> None:
    stepped, torque, q, time = (np.asarray(ran[name]) for name in ("stepped", "torque", "q", "time"))
    assert np.all(np.asarray(ran["half"]) < MEDIAN)
    turns = [0.0, *time[1:-1][np.any(np.diff(np.sign(np.diff(q, axis=0)), axis=0) != 0, axis=1)]]
    sliding = np.all([(time < turn) | (time > turn + SETTLED_S) for turn in turns], axis=0)
    sliding = (sliding & (time < time[-1] - SETTLED_S))[: len(stepped)]
    assert sliding.mean() > 0.5
    error = np.abs(stepped - torque[: len(stepped)])[sliding].max(axis=0) / np.abs(torque).max(axis=0)
    assert np.all(error < SLIDING), error


def test_the_environment_shows_currents(ran: dict[str, object]) -> None:
    seen, q = np.asarray(ran["seen"]), np.asarray(ran["q"])
    assert seen.shape == q.shape
    shown = np.asarray(ran["table"])["current_1_a"]  # type: ignore[call-overload]
    assert np.median(np.abs(seen[:, 0] - shown)) < SLIDING * np.abs(shown).max() + CURRENT_ERROR_A


@pytest.mark.skipif(not shutil.which("patch"), reason="there is no `patch` on this machine")
def test_patched_files_are_the_robot(place: Path, ran: dict[str, object]) -> None:
    found = compile_robot(load_robot(place / "found" / "robot")).model
    assert (place / "patched.xml").read_text() == (place / "found" / "robot" / "hh150.xml").read_text()
    own = mujoco.MjModel.from_xml_path(str(place / "mine.xml"))
    assert own.geom("floor").type[0] == mujoco.mjtGeom.mjGEOM_PLANE
    for field in ("body_mass", "body_inertia", "body_ipos", "body_pos", "dof_armature", "tendon_stiffness"):
        np.testing.assert_allclose(getattr(own, field), getattr(found, field), rtol=1e-12, atol=1e-14)
    nominal = mujoco.MjModel.from_xml_path(str(place / "hh150" / "hh150.xml"))
    assert np.any(own.body_mass != nominal.body_mass)


def test_a_diagnosis_names_the_command_and_the_page(place: Path) -> None:
    (line,) = [line for line in places_of(place / "found") if line.startswith("apply")]
    assert f"bench apply {place / 'found'} -o applied" in line
    (page,) = re.findall(r"more: (.*)\)", line)
    assert (Path(bench.__file__).parents[1] / page).samefile(Path(bench.report.handover.__file__).parent / "README.md")


def test_the_readme_says_what_a_urdf_cannot(place: Path, ran: dict[str, object]) -> None:
    text = (place / "applied" / "README.md").read_text()
    for words in ("rotor inertia", "stiffness of the gears", "counterbalance on hinge_a", "torque constants", "shapes"):
        assert words in text
    for name in ("robot.diff", "figures.csv"):
        assert (place / "found" / name).is_file()
