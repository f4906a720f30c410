"""The robot folder's word on how logs of that robot read."""

from pathlib import Path

from bench import paths
from bench.errors import InputError
from bench.record.log_format import LOG_FORMAT, LogFormat, read_log_format
from bench.robot.folder import Robot


def log_format_of(robot: Robot, file: Path | None = None) -> LogFormat:
    """Return how logs read: `log.yaml` of the robot's folder, or another file of that kind.

    Raises:
        InputError: There is no such file, or it breaks the schema.
    """
    path = file or robot.folder / LOG_FORMAT
    if not path.exists():  # what else is no plain file is told by who reads it
        raise InputError(
            f"{path}: no such file; `bench convert --look LOG --robot ROBOT -o log.yaml` proposes one, give it with "
            "--log log.yaml or put it there (all keys: bench/record/logs/README.md)"
        )
    return read_log_format(path)


def campaign_name(robot: Robot) -> str:
    """Return what a campaign writes for its robot: a name for one that comes along, else the path of its folder."""
    return robot.name if robot.folder.parent == paths.models_dir().resolve() else str(robot.folder)
