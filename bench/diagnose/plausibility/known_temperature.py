"""Temperatures of the gas that the lab knows besides, held against the thermometer that it logs."""

from collections.abc import Iterator

import numpy as np

from bench.diagnose.replay.noise import GAS_DRIFT_K
from bench.diagnose.replay.nuisances import THERMOMETER_K
from bench.record.campaign import Campaign
from bench.record.finding import Finding
from bench.record.known import CONTRADICTS
from bench.record.manifest import MANIFEST

COLUMN = "gas_temperature_k"


def known_temperatures(campaign: Campaign) -> Iterator[Finding]:
    """Yield a warning for each known temperature of the gas that no run of its recording comes near.

    It may have been read at any time of the recording, so it is held against the nearest run. Its own sigma, the error
    of the thermometer that logs, and the drift of gas with the air may each be what differs.

    Args:
        campaign: A checked campaign.
    """
    for i, one in enumerate(campaign.known):
        runs = [run for run in campaign.runs if one.recording in ("", run.recording) and COLUMN in run.columns]
        logged = np.array([float(np.median(run.columns[COLUMN])) for run in runs if len(run)])
        if one.quantity != COLUMN or not len(logged):
            continue
        nearest = float(logged[np.argmin(np.abs(logged - one.value))])
        apart = abs(one.value - nearest) / float(np.linalg.norm([one.sigma, THERMOMETER_K, GAS_DRIFT_K]))
        # of runs on either side of it, one was warmer and one was colder
        if apart > CONTRADICTS and not logged.min() < one.value < logged.max():
            message = (
                f"{one.value:g} ± {one.sigma:g} K, and {COLUMN} is {logged.min():.4g} to {logged.max():.4g} K in its "
                f"runs, {apart:.2g} standard errors away"
            )
            yield Finding("warning", MANIFEST, None, f"known[{i}].value", message, "correct one of them, or its sigma")
