"""Campaign folders of one machine, read, checked against their robot, and joined."""

from collections.abc import Mapping, Sequence
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
from bench.robot.folder import FIGURES_FILE, Robot

UNFINISHED = (
    "the diagnosis that fitted this robot ended before it was done",
    "what was not looked for yet may sit in the wrong figures: give it more time, or hold it against least squares",
)


@dataclass(frozen=True, eq=False)
class CheckedCampaign:
    """A campaign folder, or several joined, read and checked against the robot.

    Attributes:
        campaign: Of several folders each is a recording of it, by the folder's name.
        compiled: Its robot.
        warnings: What to look at: folder, of the campaign or its robot, and finding.
        doubts: Failed plausibility checks likewise: channels that are hardly what their names say.
    """

    campaign: Campaign
    compiled: CompiledRobot
    warnings: tuple[tuple[Path, Finding], ...]
    doubts: tuple[tuple[Path, Finding], ...]


@dataclass(frozen=True, eq=False)
class CheckedCampaigns:
    """Campaign folders side by side.

    Attributes:
        campaigns: Name -> campaign, in the order in which the folders were given.
        robots: One for each.
        warnings: As of a `CheckedCampaign`.
        doubts: Likewise, also where a campaign repeats another.
    """

    campaigns: dict[str, Campaign]
    robots: tuple[CompiledRobot, ...]
    warnings: tuple[tuple[Path, Finding], ...]
    doubts: tuple[tuple[Path, Finding], ...]


def open_checked(folder: Path, robot: str | Robot) -> CheckedCampaign:
    """Read a campaign folder and check its channels against its robot.

    Args:
        folder: Of the campaign.
        robot: The robot to take, its name or its folder; "": the one that the campaign names.

    Raises:
        CampaignError: It cannot be used.
        RobotError: The robot is unknown or broken.
    """
    report, compiled = open_campaign(folder, robot)
    campaign = report.usable()
    assert compiled  # a usable campaign comes with its robot
    doubts = (*report.doubts, *doubts_of(campaign, compiled, report.findings))
    warnings = [(folder, one) for one in report.warnings]
    if compiled.robot.figures.fitted.unfinished:
        warnings.append(
            (compiled.robot.folder, Finding("warning", FIGURES_FILE, None, "fitted.unfinished", *UNFINISHED))
        )
    return CheckedCampaign(campaign, compiled, tuple(warnings), tuple((folder, one) for one in doubts))


def open_all(folders: Sequence[Path], robot: str | Robot) -> CheckedCampaigns:
    """Read and check several campaign folders; arguments and errors as in `open_checked`.

    Raises:
        InputError: No folder is given, or one twice.
    """
    names = names_of(folders)
    opened = [open_checked(folder, robot) for folder in folders]
    campaigns = {name: one.campaign for name, one in zip(names, opened, strict=True)}
    warnings = tuple(dict.fromkeys(warning for one in opened for warning in one.warnings))
    doubts = [doubt for one in opened for doubt in one.doubts]
    doubts += [(folders[names.index(name)], found) for name, found in no_campaign_twice(campaigns)]
    return CheckedCampaigns(campaigns, tuple(one.compiled for one in opened), warnings, tuple(doubts))


def open_joint(folders: Sequence[Path], robot: str | Robot) -> CheckedCampaign:
    """Read campaign folders in the order in which they were recorded, and join them; arguments as in `open_checked`.

    Raises:
        CampaignError: A folder cannot be used, or they are not of one robot.
        InputError: No folder is given, or one twice.
        RobotError: The robot is unknown or broken.
    """
    opened = open_all(folders, robot)
    first = expect_one_robot(dict(zip(folders, opened.robots, strict=True)))
    named = next(iter(opened.campaigns.values())).robot  # the same folder may be named in several ways
    campaigns = {name: replace(campaign, robot=named) for name, campaign in opened.campaigns.items()}
    return CheckedCampaign(joined(campaigns), first, opened.warnings, opened.doubts)


def expect_one_robot(robots: Mapping[Path, CompiledRobot]) -> CompiledRobot:
    """Return the robot of campaigns.

    Args:
        robots: Folder of a campaign -> its robot.

    Raises:
        CampaignError: They are of several.
    """
    (folder, first), *others = robots.items()
    for other, robot in others:
        if robot.robot.folder.resolve() != first.robot.folder.resolve():
            raise CampaignError(
                f"{other} names the robot {robot.robot.folder}, {folder} {first.robot.folder}: give campaigns of one "
                "machine, or the robot to take with --robot"
            )
    return first
