"""Which robot a person means who asks for a prediction."""

from pathlib import Path

from bench.report.diagnosis.file_names import ROBOT
from bench.robot.folder import FIGURES_FILE


def model_folder(model: str) -> str:
    """Return the robot that `model` names; the folder of a diagnosis stands for the robot that it handed over."""
    handed = Path(model) / ROBOT
    is_robot = (Path(model) / FIGURES_FILE).is_file()
    return str(handed) if not is_robot and (handed / FIGURES_FILE).is_file() else model
