"""What each model of a world follows: segments that have payload, run and time in common; and how it moved there."""

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.instants import slices_of
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.winding import MotionSpline
from bench.diagnose.replay.world import World, log_error_of, moves
from bench.effects.conditions import Conditions
from bench.record.campaign import Array
from bench.simulate.prescribed import Motion
from bench.simulate.trace import Trace


@dataclass(frozen=True, eq=False)
class Course:
    """Segments that one model follows, one after the other.

    Attributes:
        run: Name of the only run that it is of; "" where worlds do not tell runs apart.
        recording: Name of the recording that it is of.
        conditions: Under which, as the lab knows them.
        motion: Of all of them, joined.
        instants: Shape (T,), where these stand among all instants of the campaign.
        rows: Shape (K,), where those that are read stand among all that are read.
        segments: Indices of the segments.
        spline: Through all instants of its motions.
        spread: Shape (K,) [s^2], variance of the weights with which torques are averaged over time.
    """

    run: str
    recording: str
    conditions: Conditions
    motion: Motion
    instants: NDArray[np.intp]
    rows: NDArray[np.intp]
    segments: tuple[int, ...]
    spline: MotionSpline
    spread: Array


@dataclass(frozen=True, eq=False)
class Moved:
    """How the robot of a world moved; K instants that are read, n drives.

    Attributes:
        trace: The truth at these.
        excess: Shape (K, n) [Nm] or [N], what averaged torques have more than those of the averaged motion.
    """

    trace: Trace
    excess: Array

    def __getitem__(self, rows: slice | NDArray[np.intp]) -> "Moved":
        return Moved(self.trace[rows], self.excess[rows])


def courses_of(
    segments: Sequence[Segment], models: Iterable[Hashable], *, with_temperatures: bool
) -> tuple[Course, ...]:
    """Return what each model follows.

    Args:
        segments: Of a campaign.
        models: Of each segment, what decides its model and its loads (`world.model_of`).
        with_temperatures: Whether a model is one of the temperatures of its segments, or of those of the figures.
    """
    groups: dict[Hashable, list[int]] = {}
    for i, model in enumerate(models):
        groups.setdefault(model, []).append(i)
    instants = slices_of(len(segment.motion) for segment in segments)
    rows = slices_of(count_of(segment) for segment in segments)
    courses = []
    for members in groups.values():
        first, runs = segments[members[0]], {segments[i].run for i in members}
        conditions = first.conditions
        if not with_temperatures:
            reference = Conditions.reference(len(conditions.gear_k), conditions.payload_kg)
            conditions = replace(reference, time_s=conditions.time_s)
        courses.append(
            Course(
                run=first.run if len(runs) == 1 else "",
                recording=first.recording,
                conditions=conditions,
                motion=Motion.concatenate(segments[i].motion for i in members),
                instants=_indices(instants, members),
                rows=_indices(rows, members),
                segments=tuple(members),
                spline=MotionSpline.through([segments[i] for i in members]),
                spread=np.concatenate([np.full(count_of(segments[i]), _spread(segments[i])) for i in members]),
            )
        )
    return tuple(courses)


def moves_along(world: World, course: Course) -> bool:
    """Whether a robot may move otherwise than the nominal one along a course, in a world of its recording.

    What sets in with a later run is not there yet, and an error in the log of another run is none of this course.
    """
    if any(nuisance.moves_robot for nuisance in world.deviations):
        return True
    places = [acting.place for acting in world.acting if moves(acting.effect)]
    return any(
        place.since_s <= course.conditions.time_s and (not place.runs or course.run in place.runs) for place in places
    )


def true_conditions(world: World, course: Course) -> Conditions:
    """Return the conditions of a course with the mass that was truly bolted on."""
    error = log_error_of(world, course.run)
    if error is None:
        return course.conditions
    return replace(course.conditions, payload_kg=error.bolted * course.conditions.payload_kg)


def count_of(segment: Segment) -> int:
    """Return how many instants of a segment are read."""
    return int(np.count_nonzero(segment.motion.read))


def _spread(segment: Segment) -> float:
    """Return the variance of the weights with which the torques of a segment are averaged over time [s^2]."""
    if segment.path is None or segment.is_static:
        return 0.0
    kernel = segment.path.kernel
    away = np.median(np.diff(segment.path.time)) * (np.arange(len(kernel)) - len(kernel) // 2)
    return float(kernel @ away**2)


def _indices(parts: list[slice], chosen: Iterable[int]) -> NDArray[np.intp]:
    """Return the indices of some parts, one after the other."""
    return np.concatenate([np.arange(parts[i].start, parts[i].stop) for i in chosen])
