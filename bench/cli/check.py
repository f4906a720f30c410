"""`bench check`: what is wrong with a campaign folder."""

from dataclasses import dataclass
from pathlib import Path

import tyro


@dataclass(frozen=True)
class Check:
    """Check a campaign folder, whoever wrote it; name file, row and column of every fault."""

    campaign: tyro.conf.Positional[Path]
    """Campaign folder (format: bench/record/README.md)."""

    def run(self) -> int:
        """Check and print; return the exit code: 0 without errors, 3 with."""
        from bench.diagnose.channels import doubts_of
        from bench.errors import CampaignError
        from bench.report.campaigns import open_campaign

        report, compiled = open_campaign(self.campaign)
        findings = report.findings
        if report.campaign and compiled:
            findings += doubts_of(report.campaign, compiled, report.findings)
        for finding in findings:
            print(f"{finding.level:8}{finding}")
        runs = f"{len(report.campaign.runs)} runs on {report.campaign.robot}" if report.campaign else "not usable"
        warnings = len(findings) - len(report.errors)
        print(f"{self.campaign}: {len(report.errors)} errors, {warnings} warnings; {runs}")
        return CampaignError.exit_code if report.errors else 0
