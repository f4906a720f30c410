"""Readings that stand in two runs: one table was copied over another, or is read under two names."""

from collections.abc import Iterator, Mapping, Sequence

from bench.record.campaign import Campaign, Run
from bench.record.channels import columns_of
from bench.record.finding import Finding
from bench.record.rules.copies import is_rich
from bench.record.rules.sheet import Sheet
from bench.record.rules.stuck import EFFORT

NOISY = (*EFFORT, "force", "moment", "reflector", "gas_pressure")  # no two runs agree in them to the last digit


def no_run_twice(sheets: Sequence[Sheet]) -> Iterator[Finding]:
    """No two runs read the same, however alike the robot moved: instruments are noisy."""
    seen: dict[int, str] = {}
    for sheet in sheets:
        key = _fingerprint(sheet.run)
        if key and (first := seen.setdefault(key, sheet.file)) != sheet.file:
            yield sheet.doubt("", f"holds the same readings as {first}", "one of them is a copy; leave it out")


def no_campaign_twice(campaigns: Mapping[str, Campaign]) -> Iterator[tuple[str, Finding]]:
    """Yield the name of each campaign that repeats runs of one before it, and a doubt."""
    seen: dict[int, str] = {}
    for name, campaign in campaigns.items():
        keys = {_fingerprint(run): name for run in campaign.runs}
        keys.pop(0, None)
        if repeated := [seen[key] for key in keys if key in seen]:
            message = f"{len(repeated)} of {len(campaign.runs)} runs hold the same readings as those of {repeated[0]}"
            yield (
                name,
                Finding("doubt", "all runs", None, "", message, "a copy is no recording of its own; leave it out"),
            )
        seen = keys | seen


def _fingerprint(run: Run) -> int:
    """Return a number that tells the noise of a run from that of others; 0 where nothing in it is noisy."""
    names = [column.name for column in columns_of(run.columns, *NOISY) if is_rich(run.columns[column.name])]
    return hash(tuple((name, run.columns[name].tobytes()) for name in sorted(names))) if names else 0
