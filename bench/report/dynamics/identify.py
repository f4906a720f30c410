"""From campaign folders to a first pass, and to what it predicts of other campaigns."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from threadpoolctl import threadpool_limits

from bench.errors import CampaignError
from bench.identify.dynamics.advice import Motion, advise
from bench.identify.dynamics.first_pass import first_pass
from bench.identify.dynamics.found import FirstPass, Torques
from bench.identify.dynamics.quantities import Quantity, quantities
from bench.record.campaign import Campaign
from bench.record.finding import Finding
from bench.record.joined import joined, names_of
from bench.record.rules.repeated_runs import no_campaign_twice
from bench.report.joint_campaign import expect_one_robot, open_checked
from bench.robot.compiled import CompiledRobot
from bench.robot.nominal_dynamics import nominal_dynamics


@dataclass(frozen=True)
class Dynamics:
    """A first pass with all that is shown of it.

    Attributes:
        campaigns: Folders that it was fitted to.
        found: The first pass.
        quantities: What it tells.
        motions: Which motions would tell what these data do not.
        predicted: Folder -> what three models predict of a campaign that was not fitted.
    """

    campaigns: tuple[Path, ...]
    found: FirstPass
    quantities: tuple[Quantity, ...]
    motions: tuple[Motion, ...]
    predicted: dict[Path, Torques]


@dataclass(frozen=True, eq=False)
class Recordings:
    """Campaigns of one machine, read and held against its robot, for a first pass.

    Attributes:
        named: Name -> each that is fitted.
        folders: Of these.
        held_out: Folder -> each that is only predicted.
        compiled: Their robot.
        warnings: What to look at in all of them: folder, and finding.
        doubts: Failed plausibility checks, likewise.
    """

    named: dict[str, Campaign]
    folders: tuple[Path, ...]
    held_out: dict[Path, Campaign]
    compiled: CompiledRobot
    warnings: tuple[tuple[Path, Finding], ...]
    doubts: tuple[tuple[Path, Finding], ...]


def open_recordings(folders: Sequence[Path], held_out: Sequence[Path] = (), robot: str = "") -> Recordings:
    """Read campaigns, and check that their channels are what their names say.

    Args:
        folders: Campaigns of one machine.
        held_out: Further ones, which are only predicted.
        robot: Name or folder of the robot to take; "": the one that the campaigns name.

    Raises:
        CampaignError: A folder is not a usable campaign or a copy of another, or they are of several robots.
        InputError: A folder is given twice, to be fitted or held out.
    """
    names = names_of(folders)
    names_of((*folders, *held_out))  # what was fitted cannot be predicted
    opened = {folder: open_checked(folder, robot) for folder in (*folders, *held_out)}
    compiled = expect_one_robot({folder: one.compiled for folder, one in opened.items()})
    named = {name: opened[folder].campaign for name, folder in zip(names, folders, strict=True)}
    others = {folder: opened[folder].campaign for folder in held_out}
    for name, doubt in no_campaign_twice(named | {str(folder): campaign for folder, campaign in others.items()}):
        raise CampaignError(f"{name}: {doubt}")
    return Recordings(
        named,
        tuple(folders),
        others,
        compiled,
        tuple(warning for one in opened.values() for warning in one.warnings),
        tuple(doubt for one in opened.values() for doubt in one.doubts),
    )


def identify_dynamics(recordings: Recordings, cutoff_hz: float | None = None) -> Dynamics:
    """Identify the dynamics from the motion runs of campaigns, and predict others.

    Args:
        recordings: Campaigns of one machine.
        cutoff_hz: Of the filter on model and data [Hz]; None: from the bandwidth of the motion.

    Raises:
        CampaignError: They are of different machines.
        InputError: The data do not serve; the message says why.
    """
    with threadpool_limits(1, "blas"):  # the matrices are small: threads cost more than they give
        found = first_pass(joined(recordings.named), nominal_dynamics(recordings.compiled), cutoff_hz)
        told = quantities(found)
        predicted = {folder: found.predict(campaign) for folder, campaign in recordings.held_out.items()}
        return Dynamics(recordings.folders, found, told, advise(found, told), predicted)
