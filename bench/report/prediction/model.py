"""Which robot a person means who asks for a prediction, and what is known of it."""

from pathlib import Path

from bench.diagnose.replay.posterior import Posterior
from bench.errors import RobotError
from bench.report.diagnosis.file_names import ROBOT
from bench.report.handover.posterior_file import read_posterior
from bench.robot.folder import FIGURES_FILE


def model_folder(model: str) -> str:
    """Return the robot that `model` names; the folder of a diagnosis stands for the robot that it handed over."""
    handed = Path(model) / ROBOT
    is_robot = (Path(model) / FIGURES_FILE).is_file()
    return str(handed) if not is_robot and (handed / FIGURES_FILE).is_file() else model


def known_of(folder: Path) -> Posterior | None:
    """Return what the diagnosis knew that handed a robot over; None of one that none did, or that was changed since."""
    try:
        return read_posterior(folder)
    except RobotError:
        return None
