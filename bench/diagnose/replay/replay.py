"""Replay: the model repeats a campaign, and says what every instrument should have shown.

The prediction of a `World` (`world.py`) is a simulation in MuJoCo each time; nothing here is a linearisation. A replay
does not change: what it predicts depends on the world alone, so worlds may be simulated in any order and in several
threads.
"""

from collections import OrderedDict
from collections.abc import Hashable, Iterable
from copy import copy
from dataclasses import replace
from functools import cached_property
from threading import Lock

import numpy as np

from bench.diagnose.replay.courses import Course, count_of, courses_of, slices_of, true_conditions
from bench.diagnose.replay.fitted import fitted_world
from bench.diagnose.replay.given import EARLIER, LABEL, said_before
from bench.diagnose.replay.jacobians import reflector_jacobians
from bench.diagnose.replay.known import known_value
from bench.diagnose.replay.late import read_late
from bench.diagnose.replay.levels import world_in
from bench.diagnose.replay.perfect_instruments import distorted, ideal_reading
from bench.diagnose.replay.play import expected
from bench.diagnose.replay.quantities import Quantity, predicted
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.world import (
    NOMINAL,
    World,
    key_of_motion,
    log_error_of,
    model_of,
    moved,
    steps_of,
)
from bench.effects.effect import Conditions
from bench.effects.followed import Followed
from bench.effects.levels import acts_in
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.robot.patched import Structure
from bench.simulate.bare import bare_spec
from bench.simulate.plant import Trace
from bench.simulate.prescribed import TOLERANCE, Prescribed

MOST_KNOWN = 4  # effort: motions kept, for worlds that only read differently
MOST_PLANS = 64  # effort: ways kept in which worlds share models, 0.1 MB each for 700 instants of six joints


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
        self._before: OrderedDict[float, Replay] = OrderedDict()  # seconds -> replay of the motion so long before
        self._lock = Lock()
        self._rows = slices_of(count_of(segment) for segment in segments)
        self._recordings: dict[str, list[int]] = {}  # recording -> its segments
        for i, segment in enumerate(segments):
            self._recordings.setdefault(segment.recording, []).append(i)
        self._plans: OrderedDict[Hashable, tuple[Course, ...]] = OrderedDict()
        nominal = self._courses(NOMINAL)
        # where links and passive hinges of the nominal robot balance; every search starts there
        self._found = np.zeros((sum(len(segment.motion) for segment in segments), 2, 0))
        parts = [self._followed(NOMINAL, course) for course in nominal]
        self._nominal = self._joined(nominal, [trace for trace, _ in parts])
        unknowns = parts[0][1].shape[2] if parts else 0
        self._found = np.empty((len(self._found), 2, unknowns))
        for course, (_, found) in zip(nominal, parts, strict=True):
            self._found[course.instants] = found

    @property
    def shape(self) -> tuple[int, int]:
        """Instants that are read, and quantities."""
        return sum(count_of(segment) for segment in self.segments), len(self.quantities)

    def predict(self, world: World) -> Array:
        """Return what instruments show in a world, shape (T, c), segment after segment.

        Raises:
            ConvergenceError: The model finds no balance.
            RobotError: The effect does not fit the model.
        """
        return self.read(world, self.trace(world))

    def read(self, world: World, trace: Trace) -> Array:
        """Return what the instruments of a world show of a motion, shape (T, c), segment after segment."""
        trace = self._with_late_torques(world, trace)
        given, world = world, self.whole(world)
        if not world.is_told_apart:
            shown = self._read(world, self.segments, trace)
        else:
            shown = np.empty(self.shape)
            for recording, members in self._recordings.items():
                segments = tuple(self.segments[i] for i in members)
                rows = np.concatenate([np.arange(self._rows[i].start, self._rows[i].stop) for i in members])
                shown[rows] = self._read(world_in(world, recording), segments, trace[rows])
        if any(quantity.is_known for quantity in self.quantities):
            self._say_known(shown, given, trace)
        return shown

    def _with_late_torques(self, world: World, trace: Trace) -> Trace:
        """Return a motion with the torques of drives that are read late as they were before: along an earlier motion.

        Between the instants that are read a torque may jump with the acceleration, so it is not interpolated.
        """
        late = [
            (one, acting.place)
            for acting in self.whole(world).acting
            if (one := acting.effect.lateness(acting.place, acting.values)) and one.field == "motor_torque"
        ]
        if not late:
            return trace
        torque, now = trace.motor_torque.copy(), self.trace(world).motor_torque
        for one, place in late:
            change = self._earlier(one.seconds).trace(world).motor_torque - now
            for segment, rows in zip(self.segments, self._rows, strict=True):
                if acts_in(place, segment.recording):
                    torque[rows, one.drive] += change[rows, one.drive]
        return replace(trace, motor_torque=torque)

    def _earlier(self, seconds: float) -> "Replay":
        """Return a replay of the motion some time before each instant."""
        with self._lock:
            if seconds in self._before:
                self._before.move_to_end(seconds)
                return self._before[seconds]
        other = copy(self)
        other.__dict__.pop("jacobians", None)
        other.segments = tuple(segment.earlier(seconds) for segment in self.segments)
        other._known, other._plans, other._before = OrderedDict(), OrderedDict(), OrderedDict()
        other._lock = Lock()
        courses = other._courses(NOMINAL)
        other._nominal = other._joined(courses, [other._followed(NOMINAL, course)[0] for course in courses])
        with self._lock:
            self._before[seconds] = other
            if len(self._before) > MOST_KNOWN:
                self._before.popitem(last=False)
        return other

    def _read(self, world: World, segments: tuple[Segment, ...], trace: Trace) -> Array:
        """Return the same for segments in which all of a world acts, but for what is known besides."""
        late = [acting.effect.lateness(acting.place, acting.values) for acting in world.acting]
        trace = read_late(self.compiled, segments, trace, [one for one in late if one and one.field != "motor_torque"])
        reading = ideal_reading(self.compiled, trace)
        reading = distorted(reading, segments, trace, world.acting)
        for nuisance, value in world.deviations.items():
            if nuisance.on_reading:
                reading = nuisance.on_reading(value, reading)
        return predicted(self.quantities, reading)

    def _say_known(self, values: Array, world: World, trace: Trace) -> None:
        """Write what the lab knows besides, as it is in a world; errors of the recording are not in it."""
        of_machine = [one for one in self.whole(world).acting if one.effect.level == "machine"]
        reading = distorted(ideal_reading(self.compiled, trace), self.segments, trace, of_machine)
        for segment, mine in zip(self.segments, self._rows, strict=True):
            if segment.label == LABEL:
                values[mine, self.quantities.index(EARLIER)] = said_before(world.deviations, len(segment))
        for course in self._courses(world):
            compiled, rows = self._robot(world, true_conditions(world, course)), course.rows
            for c, quantity in enumerate(self.quantities):
                if quantity.is_known and quantity != EARLIER:
                    known = quantity, compiled, trace.gas_force[rows], reading.gas_temperature[rows]
                    values[rows, c] = known_value(*known)

    def trace(self, world: World) -> Trace:
        """Return the true motion in a world at all instants that are read, segment after segment.

        Raises:
            ConvergenceError, RobotError: As `predict`.
        """
        if not world.changes_robot:
            return self._nominal
        key = key_of_motion(world)
        with self._lock:
            if key in self._known:
                self._known.move_to_end(key)
                return self._known[key]
        courses = self._courses(world)
        trace = self._joined(courses, [self._moved_along(world, course) for course in courses])
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
        for course in self._courses(world):
            segments = [self.segments[i] for i in course.segments]
            lengths = [count_of(segment) for segment in segments]
            visits = [
                first if segment.is_static else -1
                for segment, first in zip(segments, np.cumsum([0, *lengths[:-1]]), strict=True)
            ]
            followed = Followed(
                compiled=self._robot_along(world, course),
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
        if not (fitted.deviations or fitted.acting):
            return world
        return World({**fitted.deviations, **world.deviations}, (*fitted.acting, *world.acting))

    def _courses(self, world: World) -> tuple[Course, ...]:
        """Return what each model of a world follows."""
        world = self.whole(world)
        here = {recording: world_in(world, recording) for recording in self._recordings}
        models = tuple(model_of(here[s.recording], s.run, s.recording, s.conditions) for s in self.segments)
        key = models, world.depends_on_conditions
        with self._lock:
            if key in self._plans:
                self._plans.move_to_end(key)
                return self._plans[key]
        plan = courses_of(self.segments, models, with_temperatures=world.depends_on_conditions)
        with self._lock:
            self._plans[key] = plan
            if len(self._plans) > MOST_PLANS:
                self._plans.popitem(last=False)
        return plan

    def _moved_along(self, world: World, course: Course) -> Trace:
        """Return the truth along a course, at what is read of it."""
        if not world_in(world, course.recording).changes_robot:
            return self._nominal[course.rows]
        return self._followed(world, course)[0]

    def _followed(self, world: World, course: Course) -> tuple[Trace, Array]:
        """Return the truth along a course, at what is read of it, and what the search found at all its instants."""
        compiled = self._robot_along(world, course)
        world = world_in(world, course.recording)
        robot = Prescribed(compiled, self._structure.data_for(compiled), self._tolerance)
        error = log_error_of(world, course.run)
        as_fitted, _ = moved(course.motion, self.fitted)
        motion, shift = moved(as_fitted, world, error.hung if error else 1.0)
        trace, found = robot.follow(motion, self._guess(robot, course, shift))
        segments = [self.segments[i] for i in course.segments]
        rows = slices_of(count_of(segment) for segment in segments)
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
        if len(traces) == 1:
            return traces[0]
        order = np.argsort(np.concatenate([course.rows for course in courses]))
        return Trace.concatenate(traces)[order]

    def _robot_along(self, world: World, course: Course) -> CompiledRobot:
        """Return the robot that follows a course."""
        here = world_in(world, course.recording)
        return self._robot(here, true_conditions(here, course))

    def _robot(self, world: World, conditions: Conditions) -> CompiledRobot:
        return self._structure.robot(steps_of(self.whole(world), conditions))
