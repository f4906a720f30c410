"""What the robot is asked to do, as arrays: commands of a whole campaign, thinned where nothing turns round."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.second.figures import Array

THIN = 12  # control periods between instants that only lead to one that is read; laws of friction are exact over them
RATE = 1e-9  # [N, Nm] per period^2, by which a load's ramp bends where it begins or ends


@dataclass(frozen=True, eq=False)
class Sitting:
    """One part of a session in which the payload stays; P control periods, K of which are read.

    Attributes:
        start: Shape (n,) [rad], where the robot stands at first.
        commands: Shape (P, n) [rad], motor angles at the ends of the periods.
        wrenches: Shape (P, 6) [N, Nm], on the load point.
        period: Of control [s].
        ends: Shape (P,) [s], when each ends, from the start of the campaign.
        marked: Shape (K,), periods at whose end is read.
        runs: K names of runs.
        labels: K times what marks a reading at rest: pose, approach, load_step, repeat; empty in motion.
        payload_kg: As the lab knows it.
    """

    start: Array
    commands: Array
    wrenches: Array
    period: float
    ends: Array
    marked: NDArray[np.intp]
    runs: tuple[str, ...]
    labels: tuple[Mapping[str, float], ...]
    payload_kg: float


@dataclass(frozen=True, eq=False)
class Course:
    """T instants of a campaign, K of which are read; n drives.

    Attributes:
        command, velocity, acceleration, jerk: Shape (T, n), of the motors [rad].
        wrench: Shape (T, 6) [N, Nm].
        time: Shape (T,) [s], since the start of the campaign.
        passed: Shape (T,) [s], since the instant before, in which servos work.
        begins: Shape (T,) bool, first instants of sittings.
        arrives: Shape (T,) bool, first readings of a visit at rest.
        payload: Shape (T,) [kg], as the lab knows it.
        read: Shape (K,), instants that are read.
        runs, labels: Of those, as in `Sitting`.
    """

    command: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    wrench: Array
    time: Array
    passed: Array
    begins: NDArray[np.bool_]
    arrives: NDArray[np.bool_]
    payload: Array
    read: NDArray[np.intp]
    runs: tuple[str, ...]
    labels: tuple[Mapping[str, float], ...]


def course_of(sittings: Sequence[Sitting]) -> Course:
    """Return the instants at which a campaign is computed: those that are read, and what friction remembers between."""
    parts, read, arrives, count = [], [], [], 0
    for sitting in sittings:
        commands = np.concatenate([sitting.start[None], sitting.commands])
        velocity = np.gradient(commands, sitting.period, axis=0)
        acceleration = np.gradient(velocity, sitting.period, axis=0)
        jerk = np.gradient(acceleration, sitting.period, axis=0)
        rows = _instants(sitting)
        visits = [(run, words.get("pose"), words.get("approach")) for run, words in _marks(sitting)]
        fresh = [bool(words) and (i == 0 or visits[i] != visits[i - 1]) for i, (_, words) in enumerate(_marks(sitting))]
        arrived = np.zeros(len(rows), dtype=bool)
        where = np.searchsorted(rows, sitting.marked + 1)
        arrived[where[np.array(fresh, dtype=bool)]] = True
        ends = np.concatenate([[sitting.ends[0] - sitting.period], sitting.ends])
        parts.append(
            (
                commands[rows],
                velocity[rows],
                acceleration[rows],
                jerk[rows],
                np.concatenate([np.zeros((1, 6)), sitting.wrenches])[rows],
                ends[rows],
                np.diff(rows, prepend=0) * sitting.period,
                rows == 0,
                np.full(len(rows), sitting.payload_kg),
            )
        )
        read.append(count + where)
        arrives.append(arrived)
        count += len(rows)
    command, velocity, acceleration, jerk, wrench, time, passed, begins, payload = (
        np.concatenate(column) for column in zip(*parts, strict=True)
    )
    return Course(
        command,
        velocity,
        acceleration,
        jerk,
        wrench,
        time,
        passed,
        begins.astype(bool),
        np.concatenate(arrives),
        payload,
        np.concatenate(read),
        tuple(run for sitting in sittings for run in sitting.runs),
        tuple(words for sitting in sittings for words in sitting.labels),
    )


def _marks(sitting: Sitting) -> list[tuple[str, Mapping[str, float]]]:
    return list(zip(sitting.runs, sitting.labels, strict=True))


def _instants(sitting: Sitting) -> NDArray[np.intp]:
    """Return which of the start (0) and the P ends are computed: between them every angle and load goes one way."""
    commands = np.concatenate([sitting.start[None], sitting.commands])
    ways = np.sign(np.diff(commands, axis=0))
    turns = np.flatnonzero(np.any(ways[1:] != ways[:-1], axis=1)) + 1
    loads = np.concatenate([np.zeros((1, 6)), sitting.wrenches])
    bends = np.flatnonzero(np.any(np.abs(np.diff(loads, 2, axis=0)) > RATE, axis=1)) + 1
    regular = np.arange(0, len(commands), THIN)
    return np.unique(np.concatenate([[0], regular, turns, bends, sitting.marked + 1])).astype(np.intp)
