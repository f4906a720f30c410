"""Drive a sitting as a whole instead of period by period: the same physics, several times faster.

The environment answers after every control period; a script does not listen. So its commands can be handed to the
plant all at once, and only the instants that are read are kept.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, PPoly

from bench.robot.bodies import read_only
from bench.simulate.env import CONTROL_PERIOD
from bench.simulate.instruments import Instruments, Reading
from bench.simulate.plant import Plant
from bench.simulate.policy import Sitting, Step
from bench.simulate.trace import Array, Trace

NUDGE = 1e-9  # [s], by which the velocity set point is ahead of that of the position

Rows = NDArray[np.intp]


@dataclass(frozen=True)
class Course:
    """The steps of a sitting as arrays; P control periods, n drives.

    Attributes:
        start: Shape (n,) [rad], where the robot stands at first.
        commands: Shape (P, n) [rad], motor angles at the end of each period.
        wrenches: Shape (P, 6) [N, Nm], at the end of each period.
        waits: Shape (P,) [s], for how long the robot only stands after each period.
        marked: Shape (K,), periods at whose end is read, growing.
        steps: The K steps of those.
        events: (time [s], words).
    """

    start: Array
    commands: Array
    wrenches: Array
    waits: Array
    marked: Rows
    steps: tuple[Step, ...]
    events: tuple[tuple[float, str], ...]

    def __len__(self) -> int:
        return len(self.waits)

    @cached_property
    def ends(self) -> Array:
        """Shape (P,) [s], when each period ends, from the beginning of the sitting, waiting included."""
        waited = np.concatenate([[0.0], np.cumsum(self.waits)[:-1]])
        return np.asarray(CONTROL_PERIOD * np.arange(1, len(self) + 1) + waited)

    @property
    def seconds(self) -> float:
        """How long it lasts, with what is not simulated."""
        return float(self.ends[-1])

    @cached_property
    def path(self) -> CubicSpline:
        """Commands over the time that is simulated [s], smooth between the ends of the periods."""
        return smooth(self.start, self.commands)

    def steps_at(self, before_end: float) -> tuple[Step, ...]:
        """Return the steps that are read with the commands of the instant of reading.

        Args:
            before_end: How long before the end of a period is read [s].
        """
        commands = self.path(CONTROL_PERIOD * (self.marked + 1) - before_end)
        return tuple(replace(step, q_cmd=command) for step, command in zip(self.steps, commands, strict=True))


def course_of(sitting: Sitting) -> Course:
    """Return the steps of a sitting as arrays; the sitting is used up."""
    steps = list(sitting.steps)
    marked = [i for i, step in enumerate(steps) if step.mark]
    course = Course(
        start=np.array(sitting.start),
        commands=read_only([step.q_cmd for step in steps]),
        wrenches=read_only([step.wrench for step in steps]),
        waits=np.array([step.wait_s for step in steps]),
        marked=np.array(marked, dtype=np.intp),
        steps=tuple(steps[i] for i in marked),
        events=(),
    )
    events = tuple((float(course.ends[i]), step.event) for i, step in enumerate(steps) if step.event)
    return replace(course, events=events)


def smooth(start: Array, commands: Array) -> CubicSpline:
    """Return the path through commands at the ends of control periods, which begins and ends at rest.

    Between them a drive's interpolator is smooth. A velocity that jumped every 4 ms would put a saw tooth of amperes on
    the current whenever the arm accelerates, and what is read would depend on where in the period it is read.

    Args:
        start: Shape (n,) [rad], at time zero.
        commands: Shape (P, n) [rad].
    """
    times = CONTROL_PERIOD * np.arange(len(commands) + 1)
    return CubicSpline(times, np.concatenate([start[None], commands]), bc_type="clamped")


def linear(start: Array, commands: Array) -> PPoly:
    """Return the path that the environment follows: straight within each period, at constant velocity."""
    before = np.concatenate([start[None], commands[:-1]])
    times = CONTROL_PERIOD * np.arange(len(commands) + 1)
    return PPoly(np.stack([(commands - before) / CONTROL_PERIOD, before]), times)


def follow(
    plant: Plant,
    path: PPoly,
    first: int,
    wrenches: Array,
    read: Iterable[int] | Rows,
    before_end: float | None = None,
    waits: Array | None = None,
) -> Trace:
    """Follow a path, and return the truth near the end of some control periods.

    Args:
        plant: Where it is, at the end of what it did before.
        path: Of the motor angles [rad] over time [s], from `smooth` or `linear`.
        first: Period with which to begin.
        wrenches: Shape (P, 6) [N, Nm], on the load point at the end of each period from there; as long as they last.
        read: Shape (K,), which periods, growing, counted as those of the path.
        before_end: How long before the end of a period the instant lies [s], a multiple of the timestep. None: one
            timestep, the last instant that the plant knows, as the environment reads it.
        waits: Shape (P,) [s], for how long the robot only stands after each period; None: nowhere.

    Returns:
        Trace of K instants; its time is that of the plant, without what it waited.
    """
    substeps = round(CONTROL_PERIOD / plant.timestep)
    back = 1 if before_end is None else round(before_end / plant.timestep)
    periods = np.asarray(read, dtype=np.int64) - first
    stands = [] if waits is None else np.flatnonzero(waits).tolist()
    seen = []
    for begin, end in pairwise(dict.fromkeys([0, *(i + 1 for i in stands), len(wrenches)])):
        here = periods[(periods >= begin) & (periods < end)]
        rows = (here - begin + 1) * substeps - back
        stretch = path.c[:, first + begin : first + end]
        until = path(CONTROL_PERIOD * (first + end))
        seen.append(plant.track(stretch, wrenches[begin:end], substeps, rows, until, NUDGE))
        if waits is not None and waits[end - 1]:
            plant.wait(float(waits[end - 1]))
    return Trace.concatenate(seen) if len(seen) > 1 else seen[0]


def read_steps(instruments: Instruments, steps: Sequence[Step], trace: Trace) -> Reading:
    """Return what the instruments show at K instants, carrying the moving reflector round where a step says so.

    Args:
        instruments: They draw noise.
        steps: The K steps that are read.
        trace: The truth there.
    """
    cuts = [0, *(i for i, step in enumerate(steps) if step.move_reflector and i), len(steps)]
    parts = []
    for first, last in pairwise(cuts):
        if steps[first].move_reflector:
            instruments.move_reflector()
        parts.append(instruments.read(trace[first:last]))
    return Reading.concatenate(parts)
