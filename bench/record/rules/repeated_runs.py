"""Readings that stand in two runs: one table was copied over another, or is read under two names."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from bench.record.campaign import Array, Campaign, Run
from bench.record.channels import columns_of
from bench.record.finding import Finding
from bench.record.rules.copies import is_rich
from bench.record.rules.sheet import Sheet
from bench.record.rules.stuck import NOISY, TURNS, is_noisy
from bench.record.scatter import scatter_of_samples

ROUNDING = 1e-6  # of a channel's range, by which a copy may differ: written with fewer digits, or multiplied back
# derived: of the noise of a channel, by which a copy of a motion may differ that was given noise of its own. Readings
# of one thing differ by 1.4 of it; of thirty rows by less than 0.7 once in a million times
SHARE = 0.7
SPREAD = 8.0  # standard deviations of noise from the lowest to the highest reading, as far as it widens a range
FEWEST = 30  # derived: of noise fewer than 0.6 change sign in one of a hundred runs that are as short
NEIGHBOURS = 50  # effort: runs of alike totals that a run is compared with


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

    Runs with the same columns and rows are put in order of one number, the mean of a channel over its range; only
    neighbours in that order are compared reading by reading.
    """
    groups: dict[tuple[tuple[str, ...], int], list[tuple[float, int, float]]] = {}
    rich: dict[int, tuple[str, ...]] = {}
    for place, run in enumerate(runs):
        names = tuple(sorted(column.name for column in columns_of(run.columns, *NOISY)))
        rich[place] = tuple(name for name in names if is_rich(run.columns[name]))
        if rich[place] and all(np.isfinite(run.columns[name]).all() for name in rich[place]):
            values = _over_range(run.columns[rich[place][0]])
            mean = float(np.mean(values))
            slack = max(ROUNDING, SHARE * _noise(run, values)) * (1 + SPREAD * abs(mean))  # a range is wider, too
            groups.setdefault((names, len(run)), []).append((mean, place, slack))
    first: dict[int, int] = {}
    for group in groups.values():
        group.sort()
        for i, (mean, place, slack) in enumerate(group):
            for other_mean, other, _ in reversed(group[max(0, i - NEIGHBOURS) : i]):
                if mean - other_mean > slack:
                    break
                if _alike(runs[place], runs[other], [name for name in rich[place] if name in rich[other]]):
                    one, later = sorted((first.get(other, other), place))
                    first[later] = one
                    break
    return first


def _over_range(values: Array) -> Array:
    scaled: Array = values / np.ptp(values)  # rich columns are not constant
    return scaled


def _noise(run: Run, values: Array) -> float:
    """Return the noise of a channel in a motion by its third differences; 0 where these are the motion's own.

    Those of noise change sign from row to row in arccos(-3/4) / pi = 0.77 of all, those of a smooth curve hardly ever.
    """
    third = np.diff(values, 3)
    sign = np.sign(third[third != 0])
    if run.kind != "motion" or len(sign) < FEWEST or np.mean(sign[1:] != sign[:-1]) < TURNS:
        return 0.0
    return float(scatter_of_samples(values[:, None])[0])


def _alike(one: Run, other: Run, names: Sequence[str]) -> bool:
    """Whether two runs read the same: to within rounding, or by less than noise in each channel that shows some."""
    pairs = [(one.columns[name], other.columns[name]) for name in names]
    if all(np.array_equal(values, others) for values, others in pairs):
        return bool(pairs)
    scaled = [(_over_range(values), _over_range(others)) for values, others in pairs]
    rounded = all(bool(np.all(np.abs(a - b) <= ROUNDING * (1 + np.abs(a)))) for a, b in scaled)
    if rounded and any(is_noisy(values) for values, _ in pairs):
        return True
    shows_noise = False
    for a, b in scaled:
        if noise := min(_noise(one, a), _noise(other, b)):
            if np.sqrt(np.mean((a - b) ** 2)) >= SHARE * noise:
                return False
            shows_noise = True
    return shows_noise
