"""Inputs of a replay taken for something else: a joint that is turned, two joints exchanged, loads in another unit.

What drives paid tells, through gravity and the inertia of other joints; friction takes energy either way.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

import numpy as np
from scipy.spatial.transform import Rotation

from bench.diagnose.plausibility.drive_picture import DrivePicture, drive_picture, needed_torque
from bench.diagnose.plausibility.mistaken import Mistake
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import Index, Segment
from bench.errors import ConvergenceError
from bench.record.campaign import Array
from bench.record.units import STANDARD_GRAVITY

OfLoads = Callable[[Segment], Array]  # wrenches of a segment as they would be without a mistake, shape (T, 6)


def _times(factor: float) -> OfLoads:
    return lambda segment: factor * segment.motion.wrench


def _turned(degrees: float) -> OfLoads:
    turn = Rotation.from_euler("z", degrees, degrees=True).as_matrix()
    return lambda segment: np.concatenate(
        [part @ turn.T for part in np.split(segment.motion.wrench, 2, axis=1)], axis=1
    )


def _moved(steps: int) -> OfLoads:
    def of(segment: Segment) -> Array:
        wrench = segment.motion.wrench
        rows = np.clip(np.arange(len(wrench)) + steps, 0, len(wrench) - 1)
        return wrench[rows] if segment.is_static else wrench

    return of


NOTHING: OfLoads = _times(0.0)  # exact: no load
AXES = "look at the axes of the base frame"
STEPS = "did rows of the log slip? give each step its own load"
LOADS: Sequence[tuple[str, str, OfLoads]] = (
    ("have the wrong sign", "a weight is negative in z", _times(-1.0)),
    ("are about 1000 times too small", "kilonewtons? multiply by 1000", _times(1e3)),
    ("are about 10 times too small", f"kilograms? multiply by {STANDARD_GRAVITY:g}", _times(STANDARD_GRAVITY)),
)
# friction at rest may hide them, and changes from step to step do not
ELSEWHERE: Sequence[tuple[str, str, str, OfLoads]] = (
    ("load_x_n", "are turned by +90 degrees about the vertical", AXES, _turned(-90.0)),
    ("load_x_n", "are turned by -90 degrees about the vertical", AXES, _turned(90.0)),
    ("load_x_n", "point the other way round in x and y", AXES, _turned(180.0)),
    ("load_z_n", "stand one load step late", STEPS, _moved(1)),
    ("load_z_n", "stand one load step early", STEPS, _moved(-1)),
)


@dataclass(frozen=True, eq=False)
class Change:
    """How inputs and readings would be without a mistake; n drives.

    Attributes:
        order: Shape (n,), whose angle and torque joint i really has.
        angle, torque: Shape (n,), signs of both.
        loads: What they are.
    """

    order: Index
    angle: Array
    torque: Array
    loads: OfLoads = field(default=_times(1.0))


@dataclass(frozen=True, eq=False)
class Recording:
    """What is replayed.

    Attributes:
        replay: Of drives alone, by the nominal robot.
    """

    replay: Replay

    @property
    def segments(self) -> tuple[Segment, ...]:
        """With readings of drives."""
        return self.replay.segments

    @property
    def plain(self) -> Change:
        """What changes nothing."""
        n = self.replay.compiled.n_joints
        return Change(np.arange(n), np.ones(n), np.ones(n))


def mistaken_loads(picture: DrivePicture, recording: Recording) -> Iterator[Mistake]:
    """Yield loads misread, with what the model makes of the right ones; simulated."""
    if any(np.any(segment.motion.wrench) for segment in recording.segments):
        for message, remedy, loads in LOADS:
            change = replace(recording.plain, loads=loads)
            yield from _mistake(picture, recording, "load_z_n", f"loads {message}", remedy, change)


def mistaken_payload(picture: DrivePicture, without: Recording, stated: float) -> Iterator[Mistake]:
    """Yield a payload that the lab knows besides, misread, with what the model makes of the runs without it; simulated.

    Args:
        picture: What drives did, with that payload.
        without: The same recording without it.
        stated: The payload [kg].
    """
    message, remedy = f"payload_kg is {stated:g}, which no drive paid for", "look at its value and unit"
    yield from _mistake(picture, without, "known", message, remedy, without.plain)


def mistaken_joints(picture: DrivePicture, recording: Recording) -> Iterator[Mistake]:
    """Yield each joint turned and every two exchanged, with what the model makes of it; simulated."""
    names = [name or f"q_motor_{j + 1}" for j, name in enumerate(picture.names)]
    plain, compiled = recording.plain, recording.replay.compiled
    drives = [drive.joint for drive in compiled.robot.figures.drives]
    for j, drive in enumerate(drives):
        signs = np.where(plain.order == j, -1.0, 1.0)
        message = f"{drive} moves against the model's sense of turning"
        alone, both = replace(plain, angle=signs), replace(plain, angle=signs, torque=signs)
        remedy = "turn the sign of both, or the axis in the MJCF"
        yield from _mistake(picture, recording, names[j], f"{message}, torque and angle alike", remedy, both)
        yield from _mistake(picture, recording, f"q_motor_{j + 1}", message, "turn the sign of its angles", alone)
    for i, j in combinations(range(len(drives)), 2):
        if compiled.is_slide[i] == compiled.is_slide[j]:
            order = plain.order.copy()
            order[[i, j]] = j, i
            message, remedy = f"{drives[i]} and {drives[j]} are exchanged", "look at the order of the joints"
            change = replace(plain, order=order)
            yield from _mistake(picture, recording, names[i], f"{message}, torque and angle alike", remedy, change)


def _mistake(
    picture: DrivePicture, recording: Recording, column: str, message: str, remedy: str, change: Change
) -> Iterator[Mistake]:
    try:
        again = drive_picture(_again(recording, change))
    except ConvergenceError:  # the model finds no balance
        return
    there = tuple(j for j, name in enumerate(picture.names) if name)
    yield Mistake(there, (column,), message, remedy, again)


def _again(recording: Recording, change: Change) -> Replay:
    """Return the replay with a change; raises a ConvergenceError where the model finds no balance."""
    quantities, order = recording.replay.quantities, change.order
    source = [_index_of(quantities, quantity, int(order[quantity.index])) for quantity in quantities]
    found = []
    for segment in recording.segments:
        motion = replace(
            segment.motion,
            q=change.angle * segment.motion.q[:, order],
            velocity=change.angle * segment.motion.velocity[:, order],
            acceleration=change.angle * segment.motion.acceleration[:, order],
            wrench=change.loads(segment),
        )
        readings = np.full_like(segment.observed, np.nan)
        for c, other in enumerate(source):
            if other is not None:
                readings[:, c] = change.torque[quantities[c].index] * segment.observed[:, other]
        found.append(
            replace(segment, motion=motion, observed=readings, standing=segment.standing[order], average_excess=None)
        )
    return recording.replay.of(tuple(found))


def _index_of(quantities: tuple[Quantity, ...], like: Quantity, drive: int) -> int | None:
    """Return the place of another drive's quantity of the same kind, None if there is none."""
    return next((c for c, q in enumerate(quantities) if q.kind == like.kind and q.index == drive), None)


def torque_with(recording: Recording, loads: OfLoads = NOTHING) -> Array | None:
    """Return what drives need with other loads, shape (T, n) [Nm]; None: there are no loads, or there is no balance."""
    if not any(np.any(segment.motion.wrench) for segment in recording.segments):
        return None
    try:
        return needed_torque(_again(recording, replace(recording.plain, loads=loads)))
    except ConvergenceError:
        return None
