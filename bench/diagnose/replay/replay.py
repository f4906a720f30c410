"""Replay: the model repeats a campaign, and says what every instrument should have shown.

The prediction of a `World` (`world.py`) is a simulation in MuJoCo each time; nothing here is a linearisation. A replay
does not change: what it predicts depends on the world alone, so worlds may be simulated in any order and in several
threads.
"""

from collections import OrderedDict
from collections.abc import Hashable, Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from threading import Lock

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.fitted import fitted_world
from bench.diagnose.replay.jacobians import reflector_jacobians
from bench.diagnose.replay.play import expected
from bench.diagnose.replay.quantities import Quantity, predicted
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.world import (
    NOMINAL,
    World,
    changes_robot,
    depends_on_conditions,
    key_of_motion,
    moved,
    steps_of,
)
from bench.effects.effect import REFERENCE_K, Conditions, Effect, Followed
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.robot.patched import Structure
from bench.simulate.bare import bare_spec
from bench.simulate.instruments import Reading
from bench.simulate.plant import Trace
from bench.simulate.prescribed import TOLERANCE, Motion, Prescribed

MOST_KNOWN = 4  # motions kept, for worlds that only read differently


@dataclass(frozen=True, eq=False)
class Course:
    """Segments that one model follows, one after the other.

    Attributes:
        conditions: Under which.
        motion: Of all of them, joined.
        instants: Shape (T,), where these stand among all instants of the campaign.
        rows: Shape (K,), where those that are read stand among all that are read.
        segments: Indices of the segments.
    """

    conditions: Conditions
    motion: Motion
    instants: NDArray[np.intp]
    rows: NDArray[np.intp]
    segments: tuple[int, ...]


class Replay:
    """A campaign, ready to be repeated by worlds. What the nominal robot's figures hold as fitted acts in all of them.

    Args:
        compiled: The nominal robot.
        segments: The campaign.
        quantities: What is predicted.
        tolerance: Of the torques on the links, where a balance counts as found.
    """

    def __init__(
        self,
        compiled: CompiledRobot,
        segments: tuple[Segment, ...],
        quantities: tuple[Quantity, ...],
        tolerance: float = TOLERANCE,
    ) -> None:
        self.compiled = compiled
        self.segments = segments
        self.quantities = quantities
        self.fitted = fitted_world(compiled)
        self._tolerance = tolerance
        self._structure = Structure(compiled.robot, bare_spec(compiled.robot))
        self._known: OrderedDict[Hashable, Trace] = OrderedDict()
        self._lock = Lock()
        self._rows = _slices(_count(segment) for segment in segments)
        self._courses = {with_conditions: self._planned(with_conditions) for with_conditions in (False, True)}
        # where links and passive hinges of the nominal robot balance; every search starts there
        self._found = np.zeros((sum(len(segment.motion) for segment in segments), 2, 0))
        courses = self._courses_of(NOMINAL)
        parts = [self._followed(NOMINAL, course) for course in courses]
        self._nominal = self._joined(courses, [trace for trace, _ in parts])
        unknowns = parts[0][1].shape[2] if parts else 0
        self._found = np.empty((len(self._found), 2, unknowns))
        for course, (_, found) in zip(courses, parts, strict=True):
            self._found[course.instants] = found

    @property
    def shape(self) -> tuple[int, int]:
        """Instants that are read, and quantities."""
        return sum(_count(segment) for segment in self.segments), len(self.quantities)

    def predict(self, world: World) -> Array:
        """Return what instruments show in a world, shape (T, c), segment after segment.

        Raises:
            ConvergenceError: The model finds no balance.
            RobotError: The effect does not fit the model.
        """
        return self.read(world, self.trace(world))

    def read(self, world: World, trace: Trace) -> Array:
        """Return what the instruments of a world show of a motion, shape (T, c), segment after segment."""
        reading = ideal_reading(self.compiled, trace)
        world = self.whole(world)
        distorting = [acting for acting in world.acting if type(acting.effect).distort is not Effect.distort]
        if distorting:
            parts = []
            for segment, rows in zip(self.segments, self._rows, strict=True):
                seen, there = reading[rows], trace[rows]
                for acting in distorting:
                    seen = acting.effect.distort(acting.place, acting.values, seen, there, segment.conditions)
                parts.append(seen)
            reading = Reading.concatenate(parts)
        for nuisance, value in world.deviations.items():
            if nuisance.on_reading:
                reading = nuisance.on_reading(value, reading)
        return predicted(self.quantities, reading)

    def trace(self, world: World) -> Trace:
        """Return the true motion in a world at all instants that are read, segment after segment.

        Raises:
            ConvergenceError, RobotError: As `predict`.
        """
        if not changes_robot(world):
            return self._nominal
        key = key_of_motion(world)
        with self._lock:
            if key in self._known:
                self._known.move_to_end(key)
                return self._known[key]
        courses = self._courses_of(world)
        trace = self._joined(courses, [self._followed(world, course)[0] for course in courses])
        with self._lock:
            self._known[key] = trace
            if len(self._known) > MOST_KNOWN:
                self._known.popitem(last=False)
        return trace

    def traces(self, world: World) -> list[Trace]:
        """Return the true motion in a world, segment by segment."""
        trace = self.trace(world)
        return [trace[rows] for rows in self._rows]

    def followed(self, world: World) -> list[tuple[Course, Followed]]:
        """Return the robots of a world, one for each course, and what they did.

        Raises:
            ConvergenceError, RobotError: As `predict`.
        """
        trace = self.trace(world)
        found = []
        for course in self._courses_of(world):
            segments = [self.segments[i] for i in course.segments]
            lengths = [_count(segment) for segment in segments]
            visits = [
                first if segment.is_static else -1
                for segment, first in zip(segments, np.cumsum([0, *lengths[:-1]]), strict=True)
            ]
            followed = Followed(
                compiled=self._robot(world, course.conditions),
                trace=trace[course.rows],
                acceleration=course.motion.acceleration[course.motion.read],
                visit=np.repeat(visits, lengths),
                gear_k=np.repeat([segment.conditions.gear_k for segment in segments], lengths, axis=0),
            )
            found.append((course, followed))
        return found

    @cached_property
    def jacobians(self) -> Array:
        """Shape (T, r, 3, n), of the reflectors with respect to the links along the nominal motion [m/rad], [m/m]."""
        return reflector_jacobians(self.compiled, self._nominal.theta)

    def play(self, world: World) -> Array:
        """Return the play of the gears in a world, shape (n,) [rad] or [m].

        Raises:
            RobotError: The effect does not fit the model.
        """
        if not any(acting.effect.scatters for acting in world.acting):
            return self.compiled.play
        return self.robot(world).play

    def robot(self, world: World) -> CompiledRobot:
        """Return the robot in which the effects of a world act, with nominal figures, unloaded.

        Raises:
            RobotError: The effect does not fit the model.
        """
        return self._robot(World(acting=world.acting), Conditions.reference(self.compiled.n_joints))

    def whole(self, world: World) -> World:
        """Return a world with what acts in every world."""
        fitted = self.fitted
        return World({**fitted.deviations, **world.deviations}, (*fitted.acting, *world.acting))

    def _courses_of(self, world: World) -> tuple[Course, ...]:
        return self._courses[depends_on_conditions(self.whole(world))]

    def _planned(self, with_conditions: bool) -> tuple[Course, ...]:
        """Return what each model follows: one for each payload and, where temperatures count, for each run."""
        groups: dict[tuple[float, str], list[int]] = {}
        for i, segment in enumerate(self.segments):
            groups.setdefault((segment.conditions.payload_kg, segment.run if with_conditions else ""), []).append(i)
        instants = _slices(len(segment.motion) for segment in self.segments)
        courses = []
        for (payload_kg, _), members in groups.items():
            reference = Conditions.reference(self.compiled.n_joints, payload_kg)
            courses.append(
                Course(
                    conditions=self.segments[members[0]].conditions if with_conditions else reference,
                    motion=Motion.concatenate(self.segments[i].motion for i in members),
                    instants=_indices(instants, members),
                    rows=_indices(self._rows, members),
                    segments=tuple(members),
                )
            )
        return tuple(courses)

    def _followed(self, world: World, course: Course) -> tuple[Trace, Array]:
        """Return the truth along a course, at what is read of it, and what the search found at all its instants."""
        compiled = self._robot(world, course.conditions)
        robot = Prescribed(compiled, self._structure.data_for(compiled), self._tolerance)
        as_fitted, _ = moved(course.motion, self.fitted)
        motion, shift = moved(as_fitted, world)
        trace, found = robot.follow(motion, self._guess(robot, course, shift))
        segments = [self.segments[i] for i in course.segments]
        rows = _slices(_count(segment) for segment in segments)
        stretches = [(here, segment.is_static) for segment, here in zip(segments, rows, strict=True)]
        return expected(compiled, trace, stretches), found

    def _guess(self, robot: Prescribed, course: Course, shift: Array | None) -> Array | None:
        """Return where to search first, shape (T, 2, u): where the nominal robot balanced; `shift` of its motors."""
        known = self._found[course.instants]
        if known.shape[2] == 0:
            return None
        u = min(known.shape[2], robot.n_unknowns)
        guess = np.zeros((len(known), 2, robot.n_unknowns))
        guess[:, 1] = robot.slopes.sliding
        guess[:, :, :u] = known[:, :, :u]
        if shift is not None:
            guess[:, 0, : self.compiled.n_joints] += shift
        return guess

    def _joined(self, courses: Iterable[Course], traces: list[Trace]) -> Trace:
        """Return the traces of courses as one, in the order of the campaign."""
        order = np.argsort(np.concatenate([course.rows for course in courses]))
        return Trace.concatenate(traces)[order]

    def _robot(self, world: World, conditions: Conditions) -> CompiledRobot:
        return self._structure.robot(steps_of(self.whole(world), conditions))


def ideal_reading(compiled: CompiledRobot, trace: Trace) -> Reading:
    """Return what perfect instruments show; every quantity is there."""
    gauge = compiled.robot.figures.instruments.pressure
    area = gauge.piston_area_m2 if gauge else np.nan
    return Reading(
        time=trace.time,
        q_motor=trace.q,
        q_link=trace.theta,
        current=trace.motor_torque / compiled.torque_constant,
        torque=trace.motor_torque,
        force=trace.wrench[:, :3],
        moment=trace.wrench[:, 3:],
        reflectors=trace.reflectors,
        gas_pressure=trace.counterbalance_force / area,
        gas_temperature=np.full(len(trace), REFERENCE_K),
    )


def _count(segment: Segment) -> int:
    """Return how many instants of a segment are read."""
    return int(np.count_nonzero(segment.motion.read))


def _slices(lengths: Iterable[int]) -> list[slice]:
    """Return where parts of these lengths stand, one after the other."""
    edges = np.cumsum([0, *lengths]).tolist()
    return [slice(first, last) for first, last in pairwise(edges)]


def _indices(parts: list[slice], chosen: Iterable[int]) -> NDArray[np.intp]:
    """Return the indices of some parts, one after the other."""
    return np.concatenate([np.arange(parts[i].start, parts[i].stop) for i in chosen])
