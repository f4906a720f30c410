"""Which recordings are compared, in which order, and when each was made."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime

import numpy as np

from bench.diagnose.replay.noise import GAS_DRIFT_K
from bench.errors import CampaignError
from bench.record.campaign import Array, Campaign, Run
from bench.record.carried import with_payloads
from bench.record.known import PAYLOAD, Known

DAY = 86400.0  # exact: [s]
GAS_TEMPERATURE = "gas_temperature_k"  # the column, and what is known


@dataclass(frozen=True, eq=False)
class Recording:
    """One recording of the machine.

    Attributes:
        name: For people, unique.
        campaign: Its runs.
        is_after: Whether it is asked what changed in it.
        started: When it began; None where nobody wrote it down.
    """

    name: str
    campaign: Campaign
    is_after: bool
    started: datetime | None = None


def recordings_of(before: Mapping[str, Campaign], after: Mapping[str, Campaign]) -> tuple[Recording, ...]:
    """Return the recordings before, then those after; the latter by the time at which they began where all say it.

    A payload that the lab knows besides is what runs carry that state none; a temperature of the gas is what a
    thermometer showed.

    Args:
        before: Name -> campaign of the machine as it was; several recordings in it count as repeats.
        after: Name -> campaign, in the order given.

    Raises:
        CampaignError: There is none before or none after, two have the same name, or they are of different robots.
    """
    found, later = (
        [one for name, campaign in side.items() for one in _split(name, _with_known(campaign), is_after=is_after)]
        for side, is_after in ((before, False), (after, True))
    )
    if not found or not later:
        raise CampaignError("a comparison needs a recording before and at least one after")
    starts = [one.started for one in later]
    if all(starts):
        later.sort(key=_instant)
    every = [*found, *later]
    names = [one.name for one in every]
    if len(set(names)) < len(names):
        raise CampaignError(f"two recordings have the same name ({', '.join(names)}): give folders of different names")
    robots = sorted({one.campaign.robot for one in every})
    if len(robots) > 1:
        raise CampaignError(
            f"the campaigns are of different robots ({', '.join(robots)}): compare campaigns of one machine, or say "
            "with --robot which robot to take for all of them"
        )
    return tuple(every)


def days_of(recordings: Sequence[Recording]) -> Array:
    """Return when each recording began, shape (K,) [days] since the first; nan everywhere where one does not say it."""
    if not all(one.started for one in recordings):
        return np.full(len(recordings), np.nan)
    seconds = np.array([_instant(one) for one in recordings])
    return np.asarray((seconds - seconds[0]) / DAY, dtype=np.float64)


def is_used(known: Known) -> bool:
    """Whether a comparison uses what the lab knows besides.

    A temperature of the gas that is known worse than gas and a thermometer drift apart is left out.
    """
    return known.quantity == PAYLOAD or (known.quantity == GAS_TEMPERATURE and known.sigma <= GAS_DRIFT_K)


def _with_known(campaign: Campaign) -> Campaign:
    """Return a campaign whose runs carry the known payload, and have the known temperature where none was logged."""
    campaign = with_payloads(campaign)
    known = [one for one in campaign.known if one.quantity == GAS_TEMPERATURE and is_used(one)]

    def with_column(run: Run) -> Run:
        own = [one.value for one in known if one.recording in ("", run.recording)]
        if not own or GAS_TEMPERATURE in run.columns:
            return run
        return replace(run, columns={**run.columns, GAS_TEMPERATURE: np.full(len(run), float(np.mean(own)))})

    return replace(campaign, runs=tuple(map(with_column, campaign.runs)))


def _instant(one: Recording) -> float:
    assert one.started
    return one.started.timestamp()


def _split(name: str, campaign: Campaign, *, is_after: bool) -> list[Recording]:
    """Return the recordings of a campaign; the manifest says of the first alone when it began.

    Each is a campaign of its own, whose runs need no name of a recording any more.
    """
    found = []
    for i, one in enumerate(campaign.recordings):
        runs = tuple(replace(run, recording="") for run in campaign.runs if run.recording == one)
        part = replace(campaign, runs=runs, started=campaign.started if i == 0 else None)
        whole = name if not one or len(campaign.recordings) == 1 else f"{name}.{one}"
        found.append(Recording(whole, part, is_after, part.started))
    return found
