"""Readings that stand in two runs: one table was copied over another, or is read under two names."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from bench.record.campaign import Array, Campaign, Run
from bench.record.channels import columns_of
from bench.record.finding import Finding
from bench.record.rules.copies import is_rich
from bench.record.rules.sheet import Sheet
from bench.record.rules.stuck import NOISY, is_noisy

ROUNDING = 1e-6  # of a channel's range, by which a copy may differ: written with fewer digits, or multiplied back


def no_run_twice(sheets: Sequence[Sheet]) -> Iterator[Finding]:
    """No two runs read the same, however alike the robot moved: instruments are noisy."""
    first = _first_alike([sheet.run for sheet in sheets])
    for place, sheet in enumerate(sheets):
        if place in first and (other := sheets[first[place]].file) != sheet.file:
            yield sheet.doubt("", f"holds the same readings as {other}", "one of them is a copy; leave it out")


def no_campaign_twice(campaigns: Mapping[str, Campaign]) -> Iterator[tuple[str, Finding]]:
    """Yield the name of each campaign that repeats runs of one before it, and a doubt."""
    of = [(name, run) for name, campaign in campaigns.items() for run in campaign.runs]
    first = _first_alike([run for _, run in of])
    for name, campaign in campaigns.items():
        sources = [of[first[place]][0] for place, (own, _) in enumerate(of) if own == name and place in first]
        if repeated := [source for source in sources if source != name]:
            message = f"{len(repeated)} of {len(campaign.runs)} runs hold the same readings as those of {repeated[0]}"
            yield (
                name,
                Finding("doubt", "all runs", None, "", message, "a copy is no recording of its own; leave it out"),
            )


def _first_alike(runs: Sequence[Run]) -> dict[int, int]:
    """Return place of a run -> place of the first run with the same noise; runs with readings of their own are out.

    Runs with the same columns and rows are put in order of one number, a sum of their readings over their ranges; only
    neighbours in that order are compared reading by reading.
    """
    groups: dict[tuple[tuple[str, ...], int], list[tuple[float, int]]] = {}
    for place, run in enumerate(runs):
        names = tuple(sorted(c.name for c in columns_of(run.columns, *NOISY) if is_rich(run.columns[c.name])))
        if names and all(np.isfinite(run.columns[name]).all() for name in names):
            total = sum(float(np.mean(_over_range(run.columns[name]))) for name in names)
            groups.setdefault((names, len(run)), []).append((total, place))
    first: dict[int, int] = {}
    for (names, _), group in groups.items():
        group.sort()
        for i, (total, place) in enumerate(group):
            for other_total, other in reversed(group[:i]):
                if total - other_total > ROUNDING * (1 + abs(total)):
                    break
                if _alike(runs[place], runs[other], names):
                    one, later = sorted((first.get(other, other), place))
                    first[later] = one
                    break
    return first


def _over_range(values: Array) -> Array:
    scaled: Array = values / np.ptp(values)  # rich columns are not constant
    return scaled


def _alike(one: Run, other: Run, names: Sequence[str]) -> bool:
    """Whether two runs read the same: to within rounding where there is noise, else to the last digit."""
    pairs = [(one.columns[name], other.columns[name]) for name in names]
    if not any(is_noisy(values) for values, _ in pairs):
        return all(np.array_equal(values, others) for values, others in pairs)
    scaled = ((_over_range(values), _over_range(others)) for values, others in pairs)
    return all(bool(np.all(np.abs(a - b) <= ROUNDING * (1 + np.abs(a)))) for a, b in scaled)
