"""Scripted scenarios as policies: generators of one step per control period, some of which are to be read."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bench.robot.compiled import SpecEdit
from bench.simulate.env import CONTROL_PERIOD

Array = NDArray[np.float64]

BREAK = 60.0  # [s], between two sittings of one session
GENTLE = 0.5  # [rad/s^2], default acceleration of moves; rotors and arm then ask for a few kNm
# Peaks of the minimum-jerk profile 10 s^3 - 15 s^4 + 6 s^5 over 0 to 1
QUINTIC_SPEED = 15 / 8
QUINTIC_ACCELERATION = 10 / np.sqrt(3)


@dataclass(frozen=True)
class Mark:
    """Where the reading after a step belongs: a run of the campaign, and the labels of its row there.

    A run with labels is a static one, a run without is one continuous movement.
    """

    run: str
    labels: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Step:
    """One control period.

    Attributes:
        q_cmd: Shape (n,) [rad], motor angles at its end.
        wrench: Shape (6,) [N, Nm], on the load point at its end.
        mark: Where to note what the instruments read at its end, or None.
        move_reflector: Carry the moving reflector round its nests before reading.
        event: Words for the log, where something begins here.
        wait_s: Time that passes after it while the robot only stands; it is not simulated.
    """

    q_cmd: Array
    wrench: Array
    mark: Mark | None = None
    move_reflector: bool = False
    event: str = ""
    wait_s: float = 0.0


@dataclass(frozen=True)
class Sitting:
    """One part of a session in which the robot itself stays as it is.

    Attributes:
        start: Shape (n,) [rad], where the robot stands at rest, unloaded.
        steps: What to do.
        edits: Changes of the model for this part only, such as a payload.
        payload_kg: Mass bolted to the load point, which those edits put there.
        pause_s: Time that passes before it, unless it is the first of its session; it is not simulated.
    """

    start: Array
    steps: Iterable[Step]
    edits: tuple[SpecEdit, ...] = ()
    payload_kg: float = 0.0
    pause_s: float = BREAK


class Script:
    """Writes the steps of a policy: remembers the command and the wrench, and blends to the next ones.

    Args:
        q: Shape (n,) [rad], where the robot stands, unloaded.
    """

    def __init__(self, q: Array) -> None:
        self._q = np.array(q)
        self._wrench = np.zeros(6)

    def move(self, q: Array, top_speed: Array | float, acceleration: float = GENTLE) -> Iterator[Step]:
        """Move all joints to `q` [rad] at once, minimum jerk.

        Args:
            q: Shape (n,) [rad].
            top_speed: Shape (n,) or scalar [rad/s], which no joint exceeds.
            acceleration: [rad/s^2], which no joint exceeds.
        """
        way = q - self._q
        by_speed = np.max(QUINTIC_SPEED * np.abs(way) / top_speed)
        by_acceleration = np.sqrt(QUINTIC_ACCELERATION * np.max(np.abs(way)) / acceleration)
        seconds = float(max(by_speed, by_acceleration))
        start = self._q
        for s in _ramp(seconds):
            self._q = start + way * (s**3 * (10 - 15 * s + 6 * s**2))
            yield Step(self._q, self._wrench)
        self._q = np.array(q)

    def push(self, wrench: Array, seconds: float) -> Iterator[Step]:
        """Bring the wrench on the load point to `wrench` [N, Nm], linearly over `seconds`."""
        start = self._wrench
        for s in _ramp(seconds):
            self._wrench = start + s * (wrench - start)
            yield Step(self._q, self._wrench)

    def say(self, words: str) -> Iterator[Step]:
        """Stand still for one period and note in the log what begins."""
        yield Step(self._q, self._wrench, event=words)

    def hold(self, seconds: float) -> Iterator[Step]:
        """Stand still under the present wrench."""
        for _ in _ramp(seconds):
            yield Step(self._q, self._wrench)

    def follow(self, angles: Array, marks: Mapping[int, Mark]) -> Iterator[Step]:
        """Take joint angles, shape (T, n) [rad], one per control period; read at the end of periods with a mark."""
        for i, q in enumerate(angles):
            self._q = q
            yield Step(q, self._wrench, marks.get(i))

    def read(self, mark: Mark, move_reflector: bool = False) -> Iterator[Step]:
        """Stand still for one period and read at its end."""
        yield Step(self._q, self._wrench, mark, move_reflector)

    def wait(self, seconds: float) -> Iterator[Step]:
        """Stand still under the present wrench without simulating it, but for one period."""
        yield Step(self._q, self._wrench, wait_s=max(0.0, seconds - CONTROL_PERIOD))


def _ramp(seconds: float) -> Iterator[float]:
    periods = int(np.ceil(seconds / CONTROL_PERIOD))
    return (i / periods for i in range(1, periods + 1))
