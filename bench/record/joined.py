"""Several campaigns of one machine as one: each of them is a recording of it."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from bench.errors import CampaignError, InputError
from bench.record.campaign import Campaign
from bench.record.known import Known


def joined(campaigns: Mapping[str, Campaign]) -> Campaign:
    """Return several campaigns of one machine as one.

    Runs are named `<campaign>.<run>`. The recordings of a campaign that tells several apart stay apart, as
    `<campaign>.<recording>`; a campaign that does not is one recording, by the campaign's name.

    Args:
        campaigns: Name -> campaign, in the order in which they were recorded.

    Raises:
        CampaignError: They are of different robots, or their manifests give different noise.
    """
    if not campaigns:
        raise CampaignError("no campaign was given: name the folder of one at least")
    if len(campaigns) == 1:
        return next(iter(campaigns.values()))
    first_name, first = next(iter(campaigns.items()))
    runs = []
    for name, campaign in campaigns.items():
        if campaign.robot != first.robot:
            raise CampaignError(
                f"{name} is of the robot {campaign.robot!r}, {first_name} of {first.robot!r}: give "
                "campaigns of one machine"
            )
        if dict(campaign.noise) != dict(first.noise):
            raise CampaignError(
                f"{name} and {first_name} state different noise in their manifests: one instrument has one noise; "
                "state the same in both, or leave it out"
            )
        runs += [
            replace(run, name=f"{name}.{run.name}", recording=".".join(filter(None, (name, run.recording))))
            for run in campaign.runs
        ]
    known = tuple(_known_in(name, campaign, one) for name, campaign in campaigns.items() for one in campaign.known)
    return Campaign(first.robot, tuple(runs), first.started, first.noise, first.notes, known)


def _known_in(name: str, campaign: Campaign, known: Known) -> Known:
    """Return what the lab knows of a campaign, for the recordings as they are named when campaigns are joined."""
    if known.joint and not known.recording:
        return known  # of the machine
    of = known.recording or campaign.recordings[0]
    return replace(known, recording=".".join(filter(None, (name, of))))


def names_of(folders: Sequence[Path]) -> tuple[str, ...]:
    """Return a name for each of several folders: its own, with as many of those above it as tell it from the others.

    Raises:
        InputError: No folder is given, or one twice.
    """
    if not folders:
        raise InputError("no campaign was given: name the folder of one at least")
    parts = [folder.resolve().parts for folder in folders]
    for i, one in enumerate(parts):
        if one in parts[:i]:
            raise InputError(f"{folders[i]} is given twice: a recording counts once")
    return tuple(
        next(
            "-".join(one[-count:])
            for count in range(1, len(one) + 1)
            if all(other[-count:] != one[-count:] for other in parts if other is not one)
        )
        for one in parts
    )
