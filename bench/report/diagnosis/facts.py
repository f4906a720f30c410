"""What a report says beside the verdict: the data, how well each channel is explained, and how it was made.

`verdict.json` holds it under the names of the fields of `Facts`, so that a page shows no number that is not there.
"""

from dataclasses import asdict, dataclass
from importlib.metadata import version
from typing import Any

import bench
from bench.diagnose.diagnose import Diagnosis
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
    learned = learned_of(diagnosis.naming, diagnosis.discrepancy)
    return Facts(
        data=_data(diagnosis, campaign, len(readings.before)),
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
    runs = tuple(RunFacts(i + 1, run.name, run.kind, len(run), 0) for i, run in enumerate(campaign.runs))
    started = campaign.started.isoformat(" ") if campaign.started else ""
    data = Data(robot, started, campaign.notes, runs, sum(run.rows for run in runs), 0, 0)
    return Facts(data, (), (), versions(), command)


def versions() -> dict[str, str]:
    """Return package -> version of what a result depends on."""
    return {"bench": bench.__version__} | {name: version(name) for name in TOOLS}


def _data(diagnosis: Diagnosis, campaign: Campaign | None, readings: int) -> Data:
    linear = diagnosis.linear
    rows = {run.name: len(run) for run in campaign.runs} if campaign else {}
    runs: list[RunFacts] = []
    for name in linear.runs:
        mine = [segment for segment in linear.segments if segment.run == name]
        kind = "static" if mine[0].is_static else "motion"
        runs.append(RunFacts(len(runs) + 1, name, kind, rows.get(name, 0), sum(len(segment) for segment in mine)))
    for run in campaign.runs if campaign else ():
        if run.name not in linear.runs:
            runs.append(RunFacts(len(runs) + 1, run.name, run.kind, len(run), 0))
    started = campaign.started.isoformat(" ") if campaign and campaign.started else ""
    return Data(
        robot=linear.replay.compiled.robot.figures.title,
        started=started,
        notes=campaign.notes if campaign else "",
        runs=tuple(runs),
        rows=sum(rows.values()),
        compared=sum(run.compared for run in runs),
        readings=readings,
    )
