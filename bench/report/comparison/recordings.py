"""The campaign folders of a comparison."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from bench.compare.recordings import is_used
from bench.record.finding import Finding
from bench.record.manifest import MANIFEST
from bench.report.joint_campaign import CheckedCampaigns, open_all
from bench.robot.folder import Robot


def open_compared(folders: Sequence[Path], robot: Robot | None) -> CheckedCampaigns:
    """Read campaign folders as `open_all` does, and warn of what the lab knows besides that a comparison does not use.

    With `robot`, all campaigns are of that one, whatever they name; without, of the one that each names.
    """
    opened = open_all(folders, robot or "")
    words = "is not used in a comparison", "look at the sizes that are named beside it"
    unused = [
        (folder, Finding("warning", MANIFEST, None, f"known: {quantity}", *words))
        for folder, campaign in zip(folders, opened.campaigns.values(), strict=True)
        for quantity in sorted({one.quantity for one in campaign.known if not is_used(one)})
    ]
    campaigns = {
        name: replace(one, robot=str(robot.folder) if robot else one.robot) for name, one in opened.campaigns.items()
    }
    return replace(opened, campaigns=campaigns, warnings=(*opened.warnings, *unused))
