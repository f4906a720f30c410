"""`bench check`: what is wrong with a campaign folder."""

from dataclasses import dataclass
from pathlib import Path

import tyro

READ = 0.5  # of the time, about, that reading the tables takes; the rest goes into what the robot says of them


@dataclass(frozen=True)
class Check:
    """Check a campaign folder, whoever wrote it; name file, row and column of every fault."""

    campaign: tyro.conf.Positional[Path]
    """Campaign folder (format: bench/record/README.md)."""

    def run(self) -> int:
        """Check and print; return the exit code: 0, or 3 with errors or failed plausibility checks."""
        from typing import get_args

        from bench.cli.progress import progress_bar
        from bench.diagnose.plausibility.channels import doubts_of
        from bench.diagnose.plausibility.hints import hints_of
        from bench.errors import CampaignError
        from bench.record.finding import Level
        from bench.report.campaigns import open_campaign

        with progress_bar("checking") as progress:
            report, compiled = open_campaign(self.campaign)
            progress(READ)
            findings = report.findings
            if report.campaign and compiled:
                findings += doubts_of(report.campaign, compiled, report.findings)
                findings += hints_of(report.campaign, compiled, findings)
        for line in compiled.robot.figures.assumed if compiled else ():
            print(f"assumed {line}")
        for finding in findings:
            print(f"{finding.level:8}{finding}")
        runs = f"{len(report.campaign.runs)} runs on {report.campaign.robot}" if report.campaign else "not usable"
        count = {level: sum(finding.level == level for finding in findings) for level in get_args(Level)}
        doubts = f"{count['doubt']} failed plausibility checks, " if count["doubt"] else ""
        print(f"{self.campaign}: {count['error']} errors, {doubts}{count['warning']} warnings; {runs}")
        return CampaignError.exit_code if count["error"] or count["doubt"] else 0
