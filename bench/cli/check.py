"""`bench check`: what is wrong with a campaign folder."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import tyro

if TYPE_CHECKING:
    from bench.record.finding import Finding, Report
    from bench.robot.compiled import CompiledRobot

SCREEN = 40  # lines that are shown, the gravest first
READ = 0.5  # of the time, about, that reading the tables takes; the rest goes into what the robot says of them


@dataclass(frozen=True)
class Check:
    """Check a campaign folder, whoever wrote it; name file, row and column of every fault."""

    campaign: tyro.conf.Positional[Path]
    """Campaign folder (format: bench/record/README.md)."""
    store: bool = True
    """Keep what is simulated on disk for the next check, and use what is kept (bench/store/README.md)."""

    def run(self) -> int:
        """Check and print; return the exit code: 0, or 3 with errors or failed plausibility checks."""
        from typing import get_args

        from bench.cli.progress import progress_bar
        from bench.errors import CampaignError
        from bench.record.finding import Level, counted
        from bench.record.logs.likewise import at_a_glance
        from bench.report.campaigns import open_campaign

        with progress_bar("checking") as progress:
            report, compiled = open_campaign(self.campaign)
            progress(READ)
            findings = report.findings
            if compiled:
                findings += _of_robot(report, compiled, store=self.store)
        for line in compiled.robot.figures.assumed if compiled else ():
            print(f"assumed {line}")
        shown = at_a_glance(findings)
        for finding in shown[:SCREEN]:
            print(f"{finding.label:14}{finding}")
        if len(shown) > SCREEN:
            print(f"... and {len(shown) - SCREEN} more kinds of findings; put these right first")
        campaign = report.campaign
        runs = f"{counted(len(campaign.runs), 'run')} on {campaign.robot}" if campaign else "not usable"
        count = {level: sum(finding.level == level for finding in findings) for level in get_args(Level)}
        words = [counted(count["error"], "error")]
        words += [counted(count["doubt"], "failed plausibility check")] if count["doubt"] else []
        words += [counted(count["warning"], "warning")]
        print(f"{self.campaign}: {', '.join(words)}; {runs}")
        return CampaignError.exit_code if count["error"] or count["doubt"] else 0


def _of_robot(report: "Report", compiled: "CompiledRobot", *, store: bool) -> tuple["Finding", ...]:
    """Return what the robot's figures, and what the robot says of the tables, add to the findings of a report."""
    from bench.diagnose.plausibility.stated_figures import remarks_on

    found = tuple(remarks_on(compiled))
    if report.campaign is None:
        return found

    from bench.diagnose.plausibility.hints import doubts_and_hints_of
    from bench.store.place import open_store

    known = (*report.findings, *found)
    return found + doubts_and_hints_of(report.campaign, compiled, known, open_store() if store else None)
