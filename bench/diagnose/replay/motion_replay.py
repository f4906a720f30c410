"""The motion of a campaign, followed by the robots of worlds: where links balance, and what their drives pay.

A motion does not change: what it says of a world depends on that alone, so worlds may be simulated in any order and in
several threads.
"""

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.averaged_more import AveragedMore
from bench.diagnose.replay.courses import Course, Moved, count_of, courses_of, moves_along, true_conditions
from bench.diagnose.replay.fitted import fitted_world
from bench.diagnose.replay.gas_history import GasHistory
from bench.diagnose.replay.instants import at_each_instant, slices_of
from bench.diagnose.replay.jacobians import reflector_jacobians
from bench.diagnose.replay.levels import world_in
from bench.diagnose.replay.play import expected
from bench.diagnose.replay.segments import Segment
from bench.diagnose.replay.world import (
    NOMINAL,
    World,
    log_error_of,
    model_of,
    moved,
    rates_along,
    steps_of,
)
from bench.effects.conditions import Conditions
from bench.effects.effect import Acting
from bench.effects.followed import Followed
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.robot.counterbalance import Counterbalance
from bench.robot.patched import Structure
from bench.robot.recent import Recent
from bench.simulate.bare import bare_spec
from bench.simulate.prescribed import TOLERANCE, Motion, Prescribed
from bench.simulate.trace import Trace

MOST_KNOWN = 4  # effort: motions kept, for worlds that only read differently
MOST_PLANS = 64  # effort: ways kept in which worlds share models, 0.1 MB each for 700 instants of six joints
MOST_RATES = 16  # effort: errors of encoders, of which what they add to speeds and accelerations is kept
MOST_GASES = 16  # effort: cylinders, of which how warm their gas is is kept


class MotionReplay:
    """The motion of a campaign. What the nominal robot's figures hold as fitted acts in all worlds.

    Args:
        compiled: The nominal robot.
        segments: The campaign.
        tolerance: Of the torques on the links, where a balance counts as found.
        structure: The robot, ready to be changed, where another motion has it already.
        near: A motion a few milliseconds away, whose balances will do to begin with, and its gas as it is; None: none.
    """

    def __init__(
        self,
        compiled: CompiledRobot,
        segments: tuple[Segment, ...],
        tolerance: float = TOLERANCE,
        structure: Structure | None = None,
        near: "MotionReplay | None" = None,
    ) -> None:
        self.compiled = compiled
        self.segments = segments
        self.fitted = fitted_world(compiled)
        self._tolerance = tolerance
        self._structure = structure or Structure(compiled.robot, bare_spec(compiled.robot))
        self._known: Recent[Hashable, Moved] = Recent(MOST_KNOWN)
        self._rates: Recent[Hashable, tuple[Array, Array]] = Recent(MOST_RATES)
        self._averaged_more = AveragedMore()
        self._rows = slices_of(count_of(segment) for segment in segments)
        self._recordings: dict[str, list[int]] = {}  # recording -> its segments
        for i, segment in enumerate(segments):
            self._recordings.setdefault(segment.recording, []).append(i)
        self._plans: Recent[Hashable, tuple[Course, ...]] = Recent(MOST_PLANS)
        self._gas: GasHistory | None = None  # not known before the nominal robot was followed
        self._gas_rises: Recent[Counterbalance, Array] = Recent(MOST_GASES)
        self._found: Array
        if near:
            self._found, self._gas = near._found, near._gas
            return
        nominal = self._courses(NOMINAL)
        # where links and passive hinges of the nominal robot balance; every search starts there
        self._found = np.zeros((sum(len(segment.motion) for segment in segments), 2, 0))
        parts = [self._followed(NOMINAL, course)[1] for course in nominal]
        self._found = np.empty((len(self._found), 2, parts[0].shape[2] if parts else 0))
        for course, found in zip(nominal, parts, strict=True):
            self._found[course.instants] = found
        self._gas = GasHistory.of(segments, self._found[:, 0, : compiled.n_joints])

    @cached_property
    def _nominal(self) -> Moved:
        """How the nominal robot moved, followed once more: what does not move it changes nothing, to the last digit."""
        courses = self._courses(NOMINAL)
        return self._joined(courses, [self._followed(NOMINAL, course)[0] for course in courses])

    def trace(self, world: World) -> Trace:
        """Return the true motion in a world at all instants that are read, segment after segment.

        Raises:
            ConvergenceError, RobotError: As `predict`.
        """
        return self.moved(world).trace

    def moved(self, world: World) -> Moved:
        """Return how the robot of a world moved at all instants that are read, segment after segment.

        Raises:
            ConvergenceError, RobotError: As `predict`.
        """
        if not world.changes_robot:
            return self._nominal
        return self._known.get(world.key_of_motion, lambda: self._moved(world))

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
            starts = np.cumsum([0, *lengths[:-1]])
            visits = [
                start if segment.is_static else -1 for segment, start in zip(segments, starts.tolist(), strict=True)
            ]
            followed = Followed(
                compiled=self._robot_along(world, course),
                trace=trace[course.rows],
                acceleration=course.motion.acceleration[course.motion.read],
                visit=np.repeat(visits, lengths),
                first=np.repeat(starts, lengths),
                gear_k=at_each_instant(segments, [segment.conditions.gear_k for segment in segments]),
                since_start=at_each_instant(segments, [segment.conditions.time_s for segment in segments]),
                waves=partial(_waves, segments),
            )
            found.append((course, followed))
        return found

    @property
    def observed(self) -> Array:
        """Shape (T, c), what was measured; nan where nothing was."""
        return np.concatenate([segment.observed for segment in self.segments])

    @cached_property
    def jacobians(self) -> Array:
        """Shape (T, r, 3, n), of the reflectors with respect to links that stand where the motors do [m/rad], [m/m]."""
        motors = [segment.motion.q[segment.motion.read] for segment in self.segments]
        return reflector_jacobians(self.compiled, np.concatenate(motors))

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
        by_weather = world.depends_on_conditions
        return self._plans.get(
            (models, by_weather), lambda: courses_of(self.segments, models, with_temperatures=by_weather)
        )

    def _moved(self, world: World) -> Moved:
        """Return how the robot of a world moved, simulated."""
        courses = self._courses(world)
        return self._joined(courses, [self._moved_along(world, course) for course in courses])

    def _moved_along(self, world: World, course: Course) -> Moved:
        """Return how the robot of a world moved along a course, at what is read of it."""
        if not moves_along(world_in(world, course.recording), course):
            return self._nominal[course.rows]
        return self._followed(world, course)[0]

    def _followed(self, world: World, course: Course) -> tuple[Moved, Array]:
        """Return what is read of a course, and what the search found at all its instants."""
        compiled = self._robot_along(world, course)
        world = world_in(world, course.recording)
        robot = Prescribed(compiled, self._structure.data_for(compiled), self._tolerance)
        error = log_error_of(world, course.run)
        segments = [self.segments[i] for i in course.segments]
        rates_of = partial(self._rates_along, course)
        as_fitted, _ = moved(course.motion, self.fitted, rates_of=rates_of)
        motion, shift = moved(as_fitted, world, error.hung if error else 1.0, rates_of)
        motion = self._with_warm_gas(motion, compiled, course)
        trace, found, load = robot.follow(motion, self._guess(robot, course, shift))
        if np.any(course.spline.inner):
            speed, bend = course.spline.rates(load / compiled.stiffness)
            trace, found, _ = robot.follow(motion, found, (motion.velocity - speed, motion.acceleration - bend))
            trace = self._at_the_middle(trace, course, bend[motion.read])
        rows = slices_of(count_of(segment) for segment in segments)
        stretches = [(here, None if s.is_static else s.standing) for s, here in zip(segments, rows, strict=True)]
        return Moved(expected(compiled, trace, stretches), self._averaged_more.of(compiled, segments, rows)), found

    def _with_warm_gas(self, motion: Motion, compiled: CompiledRobot, course: Course) -> Motion:
        """Return the motion of a course with gas as warm as it was; most courses of a world share a cylinder."""
        cylinder, gas = compiled.counterbalance, self._gas
        if gas is None or cylinder is None or cylinder.heat_capacity_ratio == 1:
            return motion
        rise = self._gas_rises.get(cylinder, lambda: gas.rise(cylinder))
        return replace(motion, gas_rise=rise[course.instants], time=gas.time[course.instants])

    def _rates_along(self, course: Course, acting: Acting) -> tuple[Array, Array]:
        """Return what an error of the encoders adds to speeds and accelerations along a course, shape (T, n) each."""
        key = acting.effect, acting.place, tuple(acting.values.items()), course.segments
        return self._rates.get(key, lambda: rates_along([self.segments[i] for i in course.segments], acting))

    def _at_the_middle(self, trace: Trace, course: Course, bend: Array) -> Trace:
        """Return a trace with links where they are in the middle of a bin, not where averaged torques hold them.

        Args:
            trace: At what is read.
            course: Along which.
            bend: Shape (K, n), second derivatives of the winding.
        """
        less = course.spread[:, None] / 2 * bend
        reflectors = trace.reflectors + np.einsum("trxj,tj->trx", self.jacobians[course.rows], less)
        return replace(trace, theta=trace.theta + less, reflectors=reflectors)

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

    def _joined(self, courses: Iterable[Course], parts: list[Moved]) -> Moved:
        """Return what was read of courses as one, in the order of the campaign."""
        if len(parts) == 1:
            return parts[0]
        order = np.argsort(np.concatenate([course.rows for course in courses]))
        trace = Trace.concatenate([part.trace for part in parts])
        return Moved(trace, np.concatenate([part.excess for part in parts]))[order]

    def _robot_along(self, world: World, course: Course) -> CompiledRobot:
        """Return the robot that follows a course."""
        here = world_in(world, course.recording)
        return self._robot(here, true_conditions(here, course))

    def _robot(self, world: World, conditions: Conditions) -> CompiledRobot:
        return self._structure.robot(steps_of(self.whole(world), conditions))


def _waves(segments: Sequence[Segment], period: float, drive: int) -> NDArray[np.complex128]:
    """Return `Followed.waves` of segments, one after the other."""
    return np.concatenate(
        [
            segment.path.wave(period, drive)
            if segment.path
            else np.exp(2j * np.pi / period * segment.motion.q[segment.motion.read, drive])
            for segment in segments
        ]
    )
