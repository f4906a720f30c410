"""Coulomb friction at rest: a play element, which takes up what the load changes until it slides at its level."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bench.identify.readings import StaticReadings
from bench.robot.bodies import Array


@dataclass(frozen=True)
class Play:
    """Friction against the load, in m states; n joints.

    Attributes:
        torque: Shape (m, n) [Nm], between -level and level.
        direction: Shape (m, n), -1 or 1: where it last slid; also the derivative of `torque` by the level. 0: nowhere
            yet.
        slides: Shape (m, n) bool, it slides in this state.
    """

    torque: Array
    direction: Array
    slides: NDArray[np.bool_]


def play(readings: StaticReadings, drive: Array, level: Array) -> Play:
    """Return the friction of play elements that a torque drives.

    Each series starts where the approach left it, sliding its way; from the middle if the approach is not known.

    Args:
        readings: Which series the states belong to, in the order of time, and how the poses were approached.
        drive: Shape (m, n) [Nm].
        level: Shape (n,) [Nm].
    """
    came = np.zeros(len(drive)) if readings.approach is None else readings.approach.astype(np.float64)
    torque, direction = np.zeros_like(drive), np.zeros_like(drive)
    slides = np.zeros(drive.shape, dtype=np.bool_)
    for s in np.unique(readings.series):
        rows = np.flatnonzero(readings.series == s)
        start = rows[0]
        direction[start] = came[start]
        torque[start] = came[start] * level
        for before, now in pairwise(rows):
            step = drive[now] - drive[before]
            free = torque[before] + step
            torque[now] = np.clip(free, -level, level)
            slides[now] = (np.abs(free) >= level) & (step != 0)
            direction[now] = np.where(slides[now], np.sign(free), direction[before])
    return Play(torque, direction, slides)
