"""What a report says beside the verdict: the data, how well each channel is explained, and how it was made.

`verdict.json` holds it under the names of the fields of `Facts`, so that a page shows no number that is not there.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from importlib.metadata import version
from typing import Any

import bench
from bench.diagnose.diagnose import Diagnosis
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.name.learned_shape import LearnedCurve, learned_of
from bench.record.campaign import Campaign
from bench.report.diagnosis.readings import Channel, Readings

TOOLS = ("mujoco", "numpy", "scipy")


@dataclass(frozen=True)
class RunFacts:
    """One run.

    Attributes:
        number: From 1, in the order of the campaign.
        name: In the campaign.
        kind: "static" or "motion".
        rows: Of its table; 0 where the campaign is not at hand.
        compared: Instants that were compared: rests, or bins of steady motion.
    """

    number: int
    name: str
    kind: str
    rows: int
    compared: int


@dataclass(frozen=True)
class Data:
    """The campaign.

    Attributes:
        robot: Title of the robot.
        started: When the campaign began, ISO 8601; "" where nobody wrote it down.
        notes: Of the manifest.
        runs: All that were compared, then those that were not.
        rows: Of all tables; 0 where the campaign is not at hand.
        compared: Instants of all runs.
        readings: That were compared at these instants, over all channels.
    """

    robot: str
    started: str
    notes: str
    runs: tuple[RunFacts, ...]
    rows: int
    compared: int
    readings: int


@dataclass(frozen=True)
class Facts:
    """What a report says beside the verdict.

    Attributes:
        data: The campaign.
        channels: How well each is explained.
        learned: Curves of what is not listed.
        versions: Package -> version.
        command: That made the diagnosis; "" if none did.
    """

    data: Data
    channels: tuple[Channel, ...]
    learned: tuple[LearnedCurve, ...]
    versions: dict[str, str]
    command: str

    def as_json(self) -> dict[str, Any]:
        """Return what it adds to `verdict.json`."""
        return asdict(self)


def facts_of(diagnosis: Diagnosis, readings: Readings, campaign: Campaign | None, command: str) -> Facts:
    """Return the facts of a diagnosis.

    Args:
        diagnosis: The diagnosis.
        readings: Its readings.
        campaign: That was diagnosed, if it is at hand.
        command: That made it.
    """
    linear = diagnosis.linear
    learned = learned_of(diagnosis.naming, diagnosis.discrepancy)
    title = linear.replay.compiled.robot.figures.titled
    return Facts(
        data=_data(title, campaign, _compared(linear), len(readings.before)),
        channels=readings.channels,
        learned=learned.curves if learned and learned.stands_out else (),
        versions=versions(),
        command=command,
    )


def facts_without(campaign: Campaign, robot: str, command: str) -> Facts:
    """Return the facts of a campaign of which nothing was weighed.

    Args:
        campaign: That was to be diagnosed.
        robot: Title of its robot.
        command: That was to do it.
    """
    return Facts(_data(robot, campaign, {}, 0), (), (), versions(), command)


def versions() -> dict[str, str]:
    """Return package -> version of what a result depends on."""
    return {"bench": bench.__version__} | {name: version(name) for name in TOOLS}


def _data(robot: str, campaign: Campaign | None, compared: Mapping[str, tuple[str, int]], readings: int) -> Data:
    """Return the facts of a campaign, given what was compared of it: run -> its kind, and how many instants."""
    own = {run.name: run for run in campaign.runs} if campaign else {}
    unused = {name: (run.kind, 0) for name, run in own.items() if name not in compared}
    runs = tuple(
        RunFacts(number, name, kind, len(own[name]) if name in own else 0, instants)
        for number, (name, (kind, instants)) in enumerate({**compared, **unused}.items(), 1)
    )
    return Data(
        robot=robot,
        started=campaign.started.isoformat(" ") if campaign and campaign.started else "",
        notes=campaign.notes if campaign else "",
        runs=runs,
        rows=sum(map(len, own.values())),
        compared=sum(run.compared for run in runs),
        readings=readings,
    )


def _compared(linear: LinearisedModel) -> dict[str, tuple[str, int]]:
    """Return the kind of each run that was compared, and how many instants of it."""
    found = {}
    for name in linear.runs:
        mine = [segment for segment in linear.segments if segment.run == name]
        found[name] = "static" if mine[0].is_static else "motion", sum(len(one) for one in mine if not one.is_known)
    return found
