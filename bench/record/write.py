"""Write a campaign as a folder that anybody can read."""

from pathlib import Path
from typing import Literal

from bench.errors import CampaignError
from bench.record.campaign import Campaign
from bench.record.check import examine_all
from bench.record.finding import Finding
from bench.record.folder import new_folder
from bench.record.manifest import MANIFEST, manifest_text, read_manifest
from bench.record.rules.sheet import Sheet
from bench.record.table import FORMATS

TableFormat = Literal["csv", "parquet"]


def write_campaign(
    campaign: Campaign, folder: Path, table_format: TableFormat = "csv", *, replace: bool = False
) -> None:
    """Write a campaign; reading it back gives the same numbers, bit for bit.

    The folder appears complete or not at all.

    Args:
        campaign: What to write.
        folder: Where; must not exist, or be empty.
        table_format: How the tables are stored.
        replace: Whether a campaign that stands there already may be replaced.

    Raises:
        CampaignError: The campaign breaks the format and could not be read again; nothing was written.
        InputError: The folder is in use.
    """
    suffix = f".{table_format}"
    with new_folder(folder, MANIFEST, replace) as partial:
        (partial / MANIFEST).write_text(manifest_text(campaign, suffix), encoding="utf-8")
        _refuse(read_manifest(partial).findings)
        sheets = [Sheet(run, f"runs/{run.name}{suffix}", tuple(run.columns)) for run in campaign.runs]
        _refuse(examine_all(sheets))
        (partial / "runs").mkdir()
        for sheet in sheets:
            FORMATS[suffix].write(partial / sheet.file, sheet.run.columns)


def _refuse(findings: list[Finding] | tuple[Finding, ...]) -> None:
    if faults := [str(finding) for finding in findings if finding.level == "error"]:
        raise CampaignError(faults)
