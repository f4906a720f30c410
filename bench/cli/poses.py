"""`bench poses`: where to measure next."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from bench.report.measuring_poses.request import PoseRequest


@dataclass(frozen=True)
class Poses(PoseRequest):
    """Choose the measuring poses that tell most about the joint stiffness, and say what to expect of them."""

    count: Annotated[int, tyro.conf.arg(aliases=["-n"])] = 6
    """Number of poses."""
    against: str | None = "loading"
    """Loading scenario to compare with, by name or path; left out where it is for another robot."""
    out: Annotated[Path | None, tyro.conf.arg(aliases=["-o"])] = None
    """Scenario file to write, for `bench run`; must not exist yet."""
    json: bool = False
    """Print JSON instead of tables."""

    def run(self) -> int:
        """Design and print; return the exit code."""
        from bench.cli.progress import phases
        from bench.cli.seeds import checked_seed
        from bench.errors import InputError
        from bench.report.files import refuse_to_overwrite
        from bench.report.measuring_poses.plan import plan_poses
        from bench.report.measuring_poses.tables import print_json, print_plan, write_scenario

        if self.count < 1:
            raise InputError(f"-n {self.count}: give how many poses to choose, 1 or more.")
        checked_seed(self.seed)
        if self.out is not None:
            refuse_to_overwrite(self.out)
        with phases(lines=False) as shown:
            plan = plan_poses(self, shown.phase)
        if self.out is not None:
            write_scenario(plan, self.out)
        (print_json if self.json else print_plan)(plan)
        return 0
