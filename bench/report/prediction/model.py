"""Which robot a person means who names one or gives the folder of a diagnosis, and what is known of it."""

import os
from pathlib import Path

from bench.diagnose.replay.posterior import Posterior
from bench.errors import RobotError
from bench.report.diagnosis.file_names import ROBOT, VERDICT
from bench.report.dynamics.file_names import DYNAMICS
from bench.report.handover.posterior_file import read_posterior
from bench.robot.folder import FIGURES_FILE, Robot, load_robot


def load_model(model: str) -> Robot:
    """Return the robot that `model` names, read and checked; arguments as of `model_folder`.

    Raises:
        RobotError: The robot is unknown or broken.
    """
    return load_robot(model_folder(model))


def model_folder(model: str) -> str:
    """Return the robot that `model` names; the folder of a diagnosis stands for the robot that it handed over.

    Raises:
        RobotError: It is the folder of a diagnosis that handed none over, or of a first pass.
    """
    if os.path.isfile(os.path.join(model, FIGURES_FILE)):  # noqa: PTH113,PTH118  a name may be too long for pathlib
        return model
    handed = handed_over(model)
    return handed if os.path.lexists(handed) else model


def handed_over(diagnosis: str | Path) -> str:
    """Return the folder of the robot that a diagnosis handed over, which exists if this is a diagnosis' folder.

    Raises:
        RobotError: It handed none over, or is a first pass.
    """
    handed, verdict = (os.path.join(diagnosis, name) for name in (ROBOT, VERDICT))  # noqa: PTH118  as above
    if os.path.isfile(verdict) and not os.path.lexists(handed):  # noqa: PTH113
        raise RobotError(
            f"{diagnosis}: this diagnosis handed no robot over: it ended before anything was weighed, or what it "
            f"fitted is no robot ({VERDICT} says which); diagnose again, with more time where it was given --at-most."
        )
    if os.path.isfile(os.path.join(diagnosis, DYNAMICS)) and not os.path.lexists(handed):  # noqa: PTH113,PTH118
        raise RobotError(f"{diagnosis}: a first pass hands no robot over; `bench diagnose CAMPAIGN -o DIR` does.")
    return handed


def known_of(folder: Path) -> Posterior | None:
    """Return what the diagnosis knew that handed a robot over; None of one that none did, or that was changed since."""
    try:
        return read_posterior(folder)
    except RobotError:
        return None
