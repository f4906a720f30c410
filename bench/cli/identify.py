"""`bench identify`: joint stiffness from a campaign."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import tyro


@dataclass(frozen=True)
class Identify:
    """Identify the joint stiffness from the static runs of a campaign."""

    campaign: tyro.conf.Positional[Path]
    """Campaign folder (format: bench/record/README.md)."""
    method: Literal["current", "force", "force-pose", "joint", "all"] = "all"
    """Method of identification; `all` runs every one that the campaign has the channels for."""
    level: float = 0.95
    """Level of the intervals."""
    robot: str = ""
    """Robot to take, name or folder, such as the one that a diagnosis handed over; by default the campaign names it."""
    json: bool = False
    """Print JSON instead of a table."""

    def run(self) -> int:
        """Identify and print; return the exit code."""
        from bench.report.identification import identify_campaign, print_json, print_table

        result = identify_campaign(self.campaign, None if self.method == "all" else [self.method], self.robot)
        (print_json if self.json else print_table)(result, self.level)
        return 0
