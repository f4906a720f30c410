"""Which robot a person means who names one or gives the folder of a diagnosis, and what is known of it."""

import os
from pathlib import Path

from bench.diagnose.replay.posterior import Posterior
from bench.errors import RobotError
from bench.report.diagnosis.file_names import ROBOT
from bench.report.handover.posterior_file import read_posterior
from bench.robot.folder import FIGURES_FILE, Robot, load_robot


def load_model(model: str) -> Robot:
    """Return the robot that `model` names, read and checked; arguments as of `model_folder`.

    Raises:
        RobotError: The robot is unknown or broken.
    """
    return load_robot(model_folder(model))


def model_folder(model: str) -> str:
    """Return the robot that `model` names; the folder of a diagnosis stands for the robot that it handed over."""
    handed = os.path.join(model, ROBOT)  # noqa: PTH118  a name may be too long for pathlib
    is_robot, is_handed = (os.path.isfile(os.path.join(one, FIGURES_FILE)) for one in (model, handed))  # noqa: PTH113,PTH118
    return handed if is_handed and not is_robot else model


def known_of(folder: Path) -> Posterior | None:
    """Return what the diagnosis knew that handed a robot over; None of one that none did, or that was changed since."""
    try:
        return read_posterior(folder)
    except RobotError:
        return None
