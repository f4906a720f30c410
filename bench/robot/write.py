"""A robot as a new folder: its MJCF changed, its figures changed, and everything that both name."""

import shutil
from pathlib import Path

import mujoco
import yaml

from bench.errors import RobotError
from bench.record.log_format import LOG_FORMAT
from bench.robot.assets import copy_assets
from bench.robot.figures import Figures
from bench.robot.folder import FIGURES_FILE, Robot
from bench.robot.starter.pages import scene_text
from bench.robot.trial import expect_harmless
from bench.robot.xml import xml_of

HEADER = (
    "# Schema: bench/robot/figures.py and bench/robot/fitted.py; meaning of the keys: models/README.md of the bench.\n"
)


def write_robot(robot: Robot, spec: mujoco.MjSpec, figures: Figures, folder: Path, readme: str) -> str:
    """Write a robot folder; files have the names that they have in the folder of the robot that it was made of.

    Args:
        robot: That it was made of.
        spec: Its MJCF as changed and compiled; it then points at the copies of its meshes and textures.
        figures: Its figures as changed.
        folder: To write.
        readme: Contents of its README.md.

    Returns:
        The MJCF.

    Raises:
        RobotError: A mesh or texture that the MJCF names is not there.
    """
    target = folder / figures.mjcf
    target.parent.mkdir(parents=True, exist_ok=True)
    copy_assets(spec, robot.mjcf.parent, target.parent)
    text = xml_of(spec)
    target.write_text(text, encoding="utf-8")
    content = figures.model_dump(mode="json", exclude_unset=True, exclude={"fitted"})
    if fitted := figures.fitted.model_dump(mode="json", exclude_defaults=True):
        content["fitted"] = fitted
    listing = yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=120)
    (folder / FIGURES_FILE).write_text(HEADER + listing, encoding="utf-8")
    (folder / "README.md").write_text(readme, encoding="utf-8")
    if (robot.folder / LOG_FORMAT).is_file():
        shutil.copyfile(robot.folder / LOG_FORMAT, folder / LOG_FORMAT)
    if figures.scene:
        _write_scene(robot.folder / figures.scene, folder / figures.scene, target)
    return text


def _write_scene(scene: Path, copy: Path, mjcf: Path) -> None:
    """Copy a scene that includes the MJCF; where it names files that are not in the new folder, write a plain one."""
    copy.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(scene, copy)
    try:
        expect_harmless(copy)  # and so compile it
    except RobotError:
        copy.write_text(scene_text(mjcf.relative_to(copy.parent).with_suffix("").as_posix()), encoding="utf-8")
