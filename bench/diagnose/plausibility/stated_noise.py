"""Noise that a campaign states of its instruments, held against how their readings scatter.

A bench takes what is stated: noise in millimetres explains everything that a tracker in metres can read.
"""

from collections.abc import Iterator

import numpy as np

from bench.diagnose.plausibility.channels import BEYOND_GUESS
from bench.diagnose.replay.noise import FEWEST, UNIFORM, Noise
from bench.record.campaign import Array, Campaign
from bench.record.channels import columns_of
from bench.record.finding import Finding
from bench.record.manifest import MANIFEST
from bench.record.rules.labels import STATE

# Times what readings scatter: nearer, on a logarithmic scale, to what another unit would make of it (mA, mm) than to 1.
# Accuracy that is stated for repeatability is ten times as much with good instruments.
FAR = BEYOND_GUESS["torque limit"]


def noise_as_stated(campaign: Campaign) -> Iterator[Finding]:
    """Yield a warning for each quantity whose stated noise is far from how its channels scatter in the median run.

    Args:
        campaign: A checked campaign.
    """
    for quantity, stated in campaign.noise.items():
        scatters = [
            _scatter(run.kind == "static", run.columns[column.name], labels)
            for run in campaign.runs
            for labels in [[run.columns[name] for name in STATE if name in run.columns]]
            for column in columns_of(run.columns, quantity)
        ]
        known = [one for one in scatters if one > 0]
        if not known:
            continue
        least, usual = min(known), float(np.median(known))  # an arm that sways scatters by more than its instruments
        if stated > FAR * usual:
            how = f"{stated / usual:.2g} times as much as its readings scatter ({usual:.2g})"
        elif FAR * stated < least:
            how = f"{least / stated:.2g} times less than any of its readings scatter ({least:.2g})"
        else:
            continue
        message = f"{stated:g} is {how}"
        remedy = "milli or kilo? noise is in the unit of the column: A, Nm, N, m, rad, Pa"
        yield Finding("warning", MANIFEST, None, f"noise.{quantity}", message, remedy)


def _scatter(is_static: bool, values: Array, labels: list[Array]) -> float:
    """Return the standard deviation of one reading, rounding included; 0 where nobody can say.

    Args:
        is_static: Whether rows are readings at rest; then repeats of a state tell, else neighbours.
        values: Shape (n,).
        labels: Of states, shape (n,) each.
    """
    steps = np.abs(np.diff(values))
    if len(values) < FEWEST or not np.any(steps > 0):
        return 0.0
    rounding = UNIFORM * float(steps[steps > 0].min())
    if not is_static:
        return float(np.hypot(Noise.of_samples(values[:, None])[0], rounding))
    states = np.unique(np.stack([*labels, 0 * values]), axis=1, return_inverse=True)[1]
    rests = [values[states == state] for state in range(states.max() + 1)]
    variances = [float(np.var(rest, ddof=1)) for rest in rests if len(rest) > 1]
    return float(np.hypot(np.sqrt(np.median(variances)), rounding)) if variances else 0.0
