"""`bench poses`: where to measure next."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import tyro


@dataclass(frozen=True)
class Poses:
    """Choose the measuring poses that tell most about the joint stiffness, and say what to expect of them."""

    robot: str = "hh150"
    """Name of a robot folder, or a path to one."""
    count: Annotated[int, tyro.conf.arg(aliases=["-n"])] = 6
    """Number of poses."""
    method: Literal["current", "force"] = "current"
    """Method of identification that the poses are for."""
    slanting: int = 2
    """Number of poses at which the load may slant; a hanging load does not show an axis that is vertical."""
    slant_deg: float = 45.0
    """Angle between a slanting load and the vertical."""
    against: str | None = "loading"
    """Loading scenario to compare with, by name or path, if it is for the same robot."""
    after: str | None = None
    """Loading scenario whose poses have been measured already, so that the new ones complement them."""
    seed: int = 0
    """Of the candidates; the same seed gives the same poses."""
    out: Annotated[Path | None, tyro.conf.arg(aliases=["-o"])] = None
    """Scenario file to write, for `bench run`."""
    json: bool = False
    """Print JSON instead of tables."""

    def run(self) -> int:
        """Design and print; return the exit code."""
        from bench.report.measuring_poses import plan_poses, print_json, print_plan, write_scenario

        plan = plan_poses(
            self.robot, self.count, self.method, self.slanting, self.slant_deg, self.against, self.after, self.seed
        )
        if self.out is not None:
            write_scenario(plan, self.out)
        (print_json if self.json else print_plan)(plan)
        return 0
