"""A hidden campaign on disk: what the instruments saw in one folder, the truth in another beside it."""

from pathlib import Path

from bench.hide.campaign import Hidden
from bench.record.truth import write_truth
from bench.record.write import TableFormat, write_campaign

CAMPAIGN, TRUTH = "campaign", "truth"


def write_hidden(hidden: Hidden, folder: Path, table_format: TableFormat = "csv") -> None:
    """Write `campaign/` and `truth/` into an existing empty folder.

    Raises:
        CampaignError: The campaign breaks the format.
    """
    write_campaign(hidden.campaign, folder / CAMPAIGN, table_format)
    write_truth(hidden.truth, folder / TRUTH)
