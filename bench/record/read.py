"""Read a campaign that must be sound."""

from pathlib import Path

from bench.record.campaign import Campaign
from bench.record.check import check_campaign


def read_campaign(folder: Path) -> Campaign:
    """Read a campaign folder; warnings are left to `check_campaign`.

    Args:
        folder: A folder with a `campaign.yaml`.

    Raises:
        CampaignError: The campaign cannot be used; `problems` names every fault with file, row and column.
    """
    return check_campaign(folder).usable()
