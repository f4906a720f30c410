"""The campaign folders of a comparison."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from bench.diagnose.replay.noise import GAS_DRIFT_K
from bench.record.campaign import Campaign, Run
from bench.record.finding import Finding
from bench.record.known import PAYLOAD, Known
from bench.record.manifest import MANIFEST
from bench.report.joint_campaign import CheckedCampaigns, open_all
from bench.robot.folder import Robot

GAS_TEMPERATURE = "gas_temperature_k"  # the column, and what is known


def open_compared(folders: Sequence[Path], robot: Robot | None) -> CheckedCampaigns:
    """Read campaign folders as `open_all` does, and warn of what the lab knows besides that a comparison does not use.

    With `robot`, all campaigns are of that one, whatever they name; without, of the one that each names.
    """
    opened = open_all(folders, robot or "")
    words = "is not used in a comparison", "look at the sizes that are named beside it"
    unused = [
        (folder, Finding("warning", MANIFEST, None, f"known: {quantity}", *words))
        for folder, campaign in zip(folders, opened.campaigns.values(), strict=True)
        for quantity in sorted({one.quantity for one in campaign.known if not _is_used(one)})
    ]
    campaigns = {
        name: replace(with_known_gas(one), robot=str(robot.folder) if robot else one.robot)
        for name, one in opened.campaigns.items()
    }
    return replace(opened, campaigns=campaigns, warnings=(*opened.warnings, *unused))


def with_known_gas(campaign: Campaign) -> Campaign:
    """Return a campaign in which a known temperature of the gas is what a thermometer showed where none was logged.

    One that is known worse than gas and a thermometer drift apart is left out.
    """
    known = [one for one in campaign.known if one.quantity == GAS_TEMPERATURE and _is_used(one)]

    def with_column(run: Run) -> Run:
        own = [one.value for one in known if one.recording in ("", run.recording)]
        if not own or GAS_TEMPERATURE in run.columns:
            return run
        return replace(run, columns={**run.columns, GAS_TEMPERATURE: np.full(len(run), float(np.mean(own)))})

    return replace(campaign, runs=tuple(map(with_column, campaign.runs))) if known else campaign


def _is_used(known: Known) -> bool:
    return known.quantity == PAYLOAD or (known.quantity == GAS_TEMPERATURE and known.sigma <= GAS_DRIFT_K)
