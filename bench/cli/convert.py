"""`bench convert`: a campaign from a laboratory's own logs."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Convert:
    """Make a campaign of logs, one run for each file, as the `log.yaml` of the robot's folder says."""

    robot: tyro.conf.Positional[str]
    """Name of a robot folder, or a path to one."""
    source: tyro.conf.Positional[Path]
    """A log (CSV or Parquet), or a folder of logs."""
    out: Annotated[Path, tyro.conf.arg(aliases=["-o"])]
    """Campaign folder to write; must not exist yet."""
    log: Path | None = None
    """Another file in place of `log.yaml` of the robot's folder."""
    parquet: bool = False
    """Write tables as Parquet instead of CSV."""

    def run(self) -> int:
        """Convert, write, and say what was left out and what is doubtful; return the exit code."""
        from bench.record.check import check_campaign
        from bench.record.convert import convert
        from bench.record.write import write_campaign
        from bench.robot.folder import load_robot
        from bench.robot.logs import campaign_name, log_format_of

        robot = load_robot(self.robot)
        converted = convert(self.source, log_format_of(robot, self.log), campaign_name(robot))
        write_campaign(converted.campaign, self.out, "parquet" if self.parquet else "csv")
        for file, names in converted.unused.items():
            if names:
                print(f"{file}: not used: {', '.join(names)}")
        warnings = check_campaign(self.out).findings  # one with errors was not written
        for warning in warnings:
            print(f"{warning.level:8}{warning}")
        rows = sum(len(run) for run in converted.campaign.runs)
        print(f"{self.out}: {len(converted.campaign.runs)} runs, {rows} rows, {len(warnings)} warnings")
        return 0
