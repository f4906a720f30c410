"""Channels that were smoothed: their samples scatter far less than their instrument does, and than others like them."""

from collections.abc import Iterator, Sequence

import numpy as np

from bench.diagnose.plausibility.mistaken import doubt
from bench.diagnose.replay.noise import Noise
from bench.diagnose.replay.quantities import Quantity
from bench.record.campaign import Campaign
from bench.record.finding import Finding
from bench.robot.compiled import CompiledRobot

READ_ALIKE = ("current", "tau_motor", "reflector", "force", "moment")  # several channels by one kind of instrument
LEAST = 50  # declared: samples of a run in motion, below which nothing is said of how they scatter
HALVED = 0.5  # exact: of the stated noise, that a channel of half the scale has
# derived: of third differences (1, -3, 3, -1), which a running mean of three makes to (1, -2, 1, -1, 2, -1) / 3
OF_THREE = (12 / 9 / 20) ** 0.5
# derived: of the stated noise; half way, on a logarithmic scale, from a running mean of three to a halved scale
QUIET = (OF_THREE * HALVED) ** 0.5
# derived: the same way, from a halved scale to the noise as it is stated: else the instrument's figures are wrong
AS_STATED = HALVED**0.5
REMEDY = (
    "smoothed? give what the instrument read, a filter makes it late; if it was not, figures.yaml states more noise "
    "than it has (bench new-robot guesses that): write what it scatters there, drive by drive"
)


def smoothed(campaign: Campaign, compiled: CompiledRobot, quantities: Sequence[Quantity]) -> Iterator[Finding]:
    """Yield a doubt for each channel that is quieter than its instrument while others of its kind are not.

    Args:
        campaign: A checked campaign.
        compiled: Its robot.
        quantities: That it has.
    """
    noise = Noise(campaign, compiled.robot.figures)
    seen: dict[Quantity, list[tuple[float, float]]] = {}
    for run in campaign.of_kind("motion"):
        for quantity in quantities:
            is_read = quantity.column in run.columns and noise.is_stated(quantity)
            if quantity.kind not in READ_ALIKE or not is_read or len(run) < LEAST:
                continue
            values = run.columns[quantity.column]
            stated = float(np.median(noise.of(quantity, values, run)))
            if stated > 0 and np.ptp(values) > 0:
                seen.setdefault(quantity, []).append((float(noise.of_samples(values[:, None])[0]), stated))
    share = {quantity: float(np.median([is_ / stated for is_, stated in pairs])) for quantity, pairs in seen.items()}
    for quantity, own in share.items():
        others = [value for other, value in share.items() if other.kind == quantity.kind and other != quantity]
        if own < QUIET and any(value > AS_STATED for value in others):
            scatter, stated = (float(np.median(part)) for part in zip(*seen[quantity], strict=True))
            message = (
                f"scatters by {scatter:.2g} from sample to sample, its instrument by {stated:.2g}, and other channels "
                "of it do"
            )
            yield doubt(quantity.column, message, REMEDY)
