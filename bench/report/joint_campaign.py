"""Several campaign folders of one machine, read, checked and joined."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from bench.diagnose.plausibility.channels import doubts_of
from bench.errors import CampaignError
from bench.record.campaign import Campaign
from bench.record.finding import Finding
from bench.record.joined import joined, names_of
from bench.record.rules.repeated_runs import no_campaign_twice
from bench.report.campaigns import open_campaign
from bench.robot.compiled import CompiledRobot


@dataclass(frozen=True, eq=False)
class DoubtedCampaign:
    """A campaign folder, read and held against its robot.

    Attributes:
        campaign: Of it.
        compiled: Its robot.
        warnings: What to look at.
        doubts: Channels that are hardly what their names say.
    """

    campaign: Campaign
    compiled: CompiledRobot
    warnings: tuple[Finding, ...]
    doubts: tuple[Finding, ...]


def open_doubted(folder: Path, robot: str = "") -> DoubtedCampaign:
    """Read a campaign folder and hold its channels against its robot.

    Args:
        folder: Of the campaign.
        robot: Name or folder of the robot to take; "": the one that the campaign names.

    Raises:
        CampaignError: It cannot be used.
        RobotError: The robot is unknown or broken.
    """
    report, compiled = open_campaign(folder, robot)
    campaign = report.usable()
    assert compiled  # a usable campaign comes with its robot
    doubts = (*report.doubts, *doubts_of(campaign, compiled, report.findings))
    return DoubtedCampaign(campaign, compiled, report.warnings, doubts)


@dataclass(frozen=True, eq=False)
class JointCampaign:
    """Campaign folders as one campaign.

    Attributes:
        campaign: Each folder is a recording of it, by the folder's name, where there are several.
        compiled: Its robot.
        warnings: What to look at: folder, and finding.
        doubts: Channels that are hardly what their names say, likewise.
    """

    campaign: Campaign
    compiled: CompiledRobot
    warnings: tuple[tuple[Path, Finding], ...]
    doubts: tuple[tuple[Path, Finding], ...]


def open_joint(folders: Sequence[Path], robot: str = "") -> JointCampaign:
    """Read campaign folders in the order in which they were recorded.

    Args:
        folders: At least one.
        robot: Name or folder of the robot to take; "": the one that the campaigns name.

    Raises:
        CampaignError: A folder is given twice or cannot be used, or they are not of one robot.
        RobotError: The robot is unknown or broken.
    """
    names = names_of(folders)
    campaigns: dict[str, Campaign] = {}
    warnings: list[tuple[Path, Finding]] = []
    doubts: list[tuple[Path, Finding]] = []
    first: CompiledRobot | None = None
    for name, folder in zip(names, folders, strict=True):
        one = open_doubted(folder, robot)
        campaign, compiled = one.campaign, one.compiled
        first = first or compiled
        if compiled.robot.folder.resolve() != first.robot.folder.resolve():
            raise CampaignError(
                f"{folder} names the robot {compiled.robot.folder}, {folders[0]} {first.robot.folder}: give campaigns "
                "of one machine, or the robot to take with --robot"
            )
        # the same folder may be named in several ways
        campaigns[name] = replace(campaign, robot=next(iter(campaigns.values()), campaign).robot)
        warnings += [(folder, warning) for warning in one.warnings]
        doubts += [(folder, doubt) for doubt in one.doubts]
    folder_of = dict(zip(names, folders, strict=True))
    doubts += [(folder_of[name], doubt) for name, doubt in no_campaign_twice(campaigns)]
    assert first
    return JointCampaign(joined(campaigns), first, tuple(warnings), tuple(doubts))
