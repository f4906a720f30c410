"""Friction that is another one in each recording, by more than a joint diagnosis takes for ordinary.

Each recording by itself has a first pass of its own. Where these differ by more than they know, and by more than
friction differs from day to day, recordings are not of one machine as it is: `bench compare` tells what changed.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from bench.diagnose.baseline.first_look import first_look
from bench.identify.dynamics.quantities import DRIVE, Quantity, quantities
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot

APART = 5.0  # declared: standard errors, for those of least squares count no error of the model
CHANGED = 0.15  # declared: of the larger one; `bench compare` tells less


@dataclass(frozen=True)
class ChangedFriction:
    """Coulomb friction of a joint that two recordings disagree about.

    Attributes:
        name: "Coulomb friction (joint2)".
        unit: Nm or N.
        found: Recording -> value, by least squares of it alone.
    """

    name: str
    unit: str
    found: dict[str, float]


def changed_friction(campaign: Campaign, compiled: CompiledRobot) -> Iterator[ChangedFriction]:
    """Yield each joint's Coulomb friction that is surely another one in two recordings, the two farthest apart.

    Args:
        campaign: Several recordings of one machine.
        compiled: Its robot, nominal.
    """
    found: dict[str, dict[str, Quantity]] = {}
    names = campaign.recordings
    for name in names if len(names) > 1 else ():
        own = replace(campaign, runs=tuple(run for run in campaign.runs if run.recording == name))
        if look := first_look(own, compiled).found:
            title, *_ = DRIVE["coulomb"]
            levels = (one for one in quantities(look) if one.kind == "friction" and one.name.startswith(f"{title} ("))
            found[name] = {one.name: one for one in levels if one.told}
    for name in dict.fromkeys(level for levels in found.values() for level in levels):
        there = {recording: levels[name] for recording, levels in found.items() if name in levels}
        pairs = [pair for pair in combinations(there, 2) if _is_changed(*(there[one] for one in pair))]
        if pairs:
            apart = max(pairs, key=lambda pair: abs(there[pair[0]].value - there[pair[1]].value))
            yield ChangedFriction(name, there[apart[0]].unit, {one: there[one].value for one in apart})


def _is_changed(one: Quantity, other: Quantity) -> bool:
    change = abs(one.value - other.value)
    return change > APART * np.hypot(one.sigma, other.sigma) and change > CHANGED * max(one.value, other.value)
