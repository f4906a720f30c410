"""Write the folder of a started robot, and try it out before it appears."""

import re
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from bench.errors import InputError, RobotError
from bench.record.folder import new_folder
from bench.robot.assets import copy_assets
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import FIGURES_FILE, load_robot
from bench.robot.links import rigid_bodies
from bench.robot.plain_words import plain_words
from bench.robot.starter.defaults import DriveFigures, drive_figures, survey
from bench.robot.starter.mjcf import clashes, mjcf_of, with_home
from bench.robot.starter.pages import figures_text, log_text, readme_text, scene_text
from bench.robot.starter.source import Source

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")
MAX_ITERATIONS = 500
AT_REST = 1e-12  # [rad] or [m]


@dataclass(frozen=True)
class Started:
    """What was made.

    Attributes:
        compiled: The robot, compiled from its new folder.
        source: What it was made of.
        drives: Figures of its drives.
    """

    compiled: CompiledRobot
    source: Source
    drives: tuple[DriveFigures, ...]


def start_robot(name: str, source: Source, folder: Path) -> Started:
    """Write a robot folder; it appears complete and working, or not at all.

    Args:
        name: Of the robot; files are named after it.
        source: What `bench.robot.starter.source.read_source` read.
        folder: To write; must not exist, or be empty.

    Raises:
        InputError: The name or the folder cannot be used.
        RobotError: What came out does not work; the message names the place in the new MJCF or in the file given.
    """
    if not NAME.fullmatch(name):
        raise InputError(f"name {name!r}: use letters, digits, '_', '-' and '.'; files are named after it.")
    if faults := tuple(clashes(source)):
        raise RobotError(faults)
    with new_folder(folder, FIGURES_FILE, replace=False) as partial:
        model = _compile(source)
        found = survey(source, model)
        drives = drive_figures(source, found)
        copy_assets(source.spec, source.file.resolve().parent, partial)
        mjcf = mjcf_of(name, source, drives, source.spec.to_xml())
        (partial / f"{name}.xml").write_text(mjcf, encoding="utf-8")
        (partial / "scene.xml").write_text(scene_text(name), encoding="utf-8")
        (partial / FIGURES_FILE).write_text(figures_text(name, source, drives, found), encoding="utf-8")
        (partial / "log.yaml").write_text(log_text(source), encoding="utf-8")
        (partial / "README.md").write_text(readme_text(name, source, drives, found), encoding="utf-8")
        compiled = _compiled(source, partial)
        home = _rest(compiled, source)
        (partial / f"{name}.xml").write_text(with_home(mjcf, *home), encoding="utf-8")
        _compiled(source, partial)
    return Started(compile_robot(load_robot(folder)), source, drives)


def _compile(source: Source) -> mujoco.MjModel:
    try:
        return source.spec.compile()
    except ValueError as error:
        raise RobotError(f"{source.file}: with the driven joints alone: {plain_words(error)}") from error


def _compiled(source: Source, partial: Path) -> CompiledRobot:
    """Return the robot of the folder in the making; what does not work there is said of the file that it is made of."""
    try:
        compiled = compile_robot(load_robot(partial))
        rigid_bodies(compiled)
    except RobotError as error:
        problems = (
            problem.replace(f"{partial.resolve()}/", "").replace(f"{partial}/", "") for problem in error.problems
        )
        raise RobotError(f"{source.file}: the robot made of it: {problem}" for problem in problems) from error
    return compiled


def _rest(compiled: CompiledRobot, source: Source) -> tuple[list[float], list[float], list[float]]:
    """Return qpos, act and ctrl of the robot at rest at its home: theta = q - G(theta) / k, by fixed point.

    Raises:
        RobotError: It finds no rest there.
    """
    model, at = compiled.model, compiled.at
    data, home = mujoco.MjData(model), np.array([joint.home for joint in source.joints])
    data.qpos[at.q] = data.qpos[at.theta] = home
    for _ in range(MAX_ITERATIONS):
        mujoco.mj_forward(model, data)
        torque = data.qfrc_bias[at.theta_dof].copy()
        moved = home - torque / compiled.stiffness - data.qpos[at.theta]
        data.qpos[at.theta] += moved
        if np.max(np.abs(moved)) < AT_REST:
            break
    else:
        raise RobotError(f"{source.file}: the robot finds no rest at its home; are masses and lengths in kg and m?")
    gain = model.actuator_gainprm[at.servo, 0]
    data.act[model.actuator_actadr[at.servo]] = torque / gain
    data.ctrl[at.servo_ctrl] = home
    return data.qpos.tolist(), data.act.tolist(), data.ctrl.tolist()
