"""From campaign folders to a first pass, and to what it predicts of other campaigns."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from threadpoolctl import threadpool_limits

from bench.errors import CampaignError
from bench.identify.dynamics.advice import Motion, advise
from bench.identify.dynamics.first_pass import FirstPass, Torques, first_pass
from bench.identify.dynamics.quantities import Quantity, quantities
from bench.record.campaign import Campaign
from bench.record.joined import joined, names_of
from bench.record.rules.repeated_runs import no_campaign_twice
from bench.report.campaigns import open_campaign
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


def identify_dynamics(
    folders: Sequence[Path], held_out: Sequence[Path] = (), robot: str = "", cutoff_hz: float | None = None
) -> Dynamics:
    """Identify the dynamics from the motion runs of campaigns, and predict others.

    Args:
        folders: Campaigns of one machine with one payload.
        held_out: Further ones, which are only predicted.
        robot: Name or folder of the robot to take; "": the one that the campaigns name.
        cutoff_hz: Of the filter on model and data [Hz]; None: from the bandwidth of the motion.

    Raises:
        CampaignError: A folder is not a usable campaign or a copy of another, or they are of different machines.
        InputError: A folder is given twice, or the data do not serve; the message says why.
    """
    named: dict[str, Campaign] = {}
    for name, folder in zip(names_of(folders), folders, strict=True):
        named[name], compiled = _opened(folder, robot)
    others = {folder: _opened(folder, robot)[0] for folder in held_out}
    for name, doubt in no_campaign_twice(named | {str(folder): campaign for folder, campaign in others.items()}):
        raise CampaignError(f"{name}: {doubt}")
    with threadpool_limits(1, "blas"):  # the matrices are small: threads cost more than they give
        found = first_pass(joined(named), nominal_dynamics(compiled), cutoff_hz)
        told = quantities(found)
        predicted = {folder: found.predict(campaign) for folder, campaign in others.items()}
        return Dynamics(tuple(folders), found, told, advise(found, told), predicted)


def _opened(folder: Path, robot: str) -> tuple[Campaign, CompiledRobot]:
    report, compiled = open_campaign(folder, robot)
    campaign = report.usable()
    assert compiled is not None  # a usable campaign comes with its robot
    return campaign, compiled
