"""First looks at drives, and robots that state how well their rotors are known."""

from dataclasses import replace

import numpy as np

from bench.diagnose.plausibility.drive_looks import DriveLook, Factor
from bench.robot.compiled import CompiledRobot


def looks(motion: np.ndarray) -> list[DriveLook]:
    """Return looks at drives whose inertia shows by these factors, shape (n,), and all else as stated."""
    one = Factor(1.0, 1e-3)
    return [DriveLook(j, f"current_{j + 1}_a", one, one, Factor(m, 1e-3), fits=True) for j, m in enumerate(motion)]


def stating_rotors(robot: CompiledRobot, *sigmas: float) -> CompiledRobot:
    """Return a robot that states of each drive how well its rotor inertia is known."""
    known = robot.robot.figures.uncertainty.model_copy(update={"rotor_inertia": sigmas})
    return replace(
        robot, robot=replace(robot.robot, figures=robot.robot.figures.model_copy(update={"uncertainty": known}))
    )
