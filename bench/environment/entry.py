"""What `gymnasium.make("bench:Bench-v0", ...)` calls."""

from pathlib import Path
from typing import Any

from bench.errors import InputError
from bench.simulate.env import BenchEnv


def make(robot: str | Path = "", posterior: str | Path | None = None, **options: Any) -> BenchEnv:
    """Return an environment.

    Args:
        robot: Name of a robot, its folder, or the folder of a diagnosis, which stands for the robot that it handed
            over.
        posterior: Folder of a diagnosis. With each reset a robot is drawn from what that diagnosis knows, about the
            robot that it handed over; `robot` is left out then.
        options: As of `BenchEnv`.

    Raises:
        InputError: Neither or both of `robot` and `posterior` are given, or as `BenchEnv`.
        RobotError: The folder holds no robot that a diagnosis handed over, or no posterior; or as `BenchEnv`.
    """
    from bench.report.prediction.model import model_folder

    if posterior is None:
        if not str(robot):
            raise InputError("robot: name one, or give the folder of a diagnosis as `posterior`.")
        return BenchEnv(model_folder(str(robot)), **options)
    if str(robot):
        raise InputError("robot and posterior: a diagnosis brings its own robot; give one of the two.")
    if "draw" in options:
        raise InputError("draw and posterior: both draw the robot; give one of the two.")
    from bench.environment.drawn import PosteriorDraws
    from bench.report.handover.posterior_file import read_posterior
    from bench.robot.compiled import compile_robot
    from bench.robot.folder import load_robot

    folder = model_folder(str(posterior))
    known = read_posterior(Path(folder))
    return BenchEnv(folder, draw=PosteriorDraws(known, compile_robot(load_robot(folder))), **options)
