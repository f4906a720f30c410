"""The stranger's arm as `bench new-robot` starts it, without a word from him."""

from pathlib import Path

from bench.robot.nominal_dynamics import NominalDynamics, nominal_dynamics
from bench.robot.starter.folder import start_robot
from bench.robot.starter.source import read_source
from tests import stranger


def started(folder: Path) -> NominalDynamics:
    """Return its nominal dynamics; the robot's folder is written into a folder that is there."""
    (folder / "arm.xml").write_text(stranger.mjcf())
    return nominal_dynamics(start_robot("arm", read_source(folder / "arm.xml"), folder / "arm").compiled)
