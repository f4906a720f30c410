"""The standard session as sittings: those of its parts, one after the other, their runs renamed to be unique."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from bench.robot.folder import Robot
from bench.scenario.dwell import DwellPart
from bench.scenario.line import LinePart
from bench.scenario.loading import LoadingPart
from bench.scenario.session import Part, SessionScenario
from bench.simulate.dwell import dwell_sittings
from bench.simulate.line import line_sittings
from bench.simulate.loading import loading_sittings
from bench.simulate.policy import Sitting, Step
from bench.simulate.rotation import rotation_sittings


def session_sittings(scenario: SessionScenario, robot: Robot) -> tuple[Sitting, ...]:
    """Return the sittings of all parts, with a break before each part."""
    sittings: list[Sitting] = []
    for _, prefix, part in scenario.parts():
        first, *others = (_named(sitting, prefix) for sitting in _sittings(part, robot))
        sittings += [replace(first, pause_s=scenario.break_s), *others]
    return tuple(sittings)


def _sittings(part: Part, robot: Robot) -> tuple[Sitting, ...]:
    match part:
        case LoadingPart():
            return loading_sittings(part, robot)
        case LinePart():
            return line_sittings(part, robot)
        case DwellPart():
            return dwell_sittings(part, robot)
        case _:
            return rotation_sittings(part, robot)


def _named(sitting: Sitting, prefix: str) -> Sitting:
    return replace(sitting, steps=_renamed(sitting.steps, prefix)) if prefix else sitting


def _renamed(steps: Iterable[Step], prefix: str) -> Iterator[Step]:
    for step in steps:
        yield replace(step, mark=replace(step.mark, run=prefix + step.mark.run)) if step.mark else step
