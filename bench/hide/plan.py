"""A session as a list of sittings, each with its time, its model and the conditions under which it happens."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import mujoco
import numpy as np

from bench.effects.conditions import Conditions
from bench.hide.pieces import Piece, pieces_of
from bench.hide.warm_up import Spell, WarmUp
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot, SpecEdit, compile_robot
from bench.robot.folder import Robot
from bench.scenario.files import Experiment
from bench.simulate.bare import bare_spec
from bench.simulate.batch import Course, Rows, course_of
from bench.simulate.drive import Log
from bench.simulate.policy import Sitting, Step
from bench.simulate.session import edits_of, sittings_of

Loads = Callable[[Array], Array]


@dataclass(frozen=True)
class Stay:
    """One sitting of a session with everything that shapes it.

    Attributes:
        course: What to do.
        edits: Changes of the model that hold throughout: the scenario's, a payload, background errors.
        begin: When it begins, from the start of the campaign [s].
        pieces: Of the course.
        conditions: Of each piece.
        loads: From nominal loads on the load point, shape (P, 6) [N, Nm], to true ones.
    """

    course: Course
    edits: tuple[SpecEdit, ...]
    begin: float
    pieces: tuple[Piece, ...]
    conditions: tuple[Conditions, ...]
    loads: Loads

    def read(self) -> Iterator[tuple[Conditions, Rows]]:
        """Yield the conditions of each piece, with which of the instants that are read lie in it."""
        marked = self.course.marked
        for piece, conditions in zip(self.pieces, self.conditions, strict=True):
            yield conditions, np.flatnonzero((marked >= piece.first) & (marked < piece.last))


@dataclass(frozen=True)
class Leg:
    """A sitting of which nothing was drawn yet.

    Attributes:
        course: What to do.
        edits: Changes of the model for this part only, such as a payload.
        payload_kg: Mass bolted to the load point.
        pause_s: Time that passes before it [s].
        pieces: Of the course.
        moves: Of each piece, whether a command or a load changes in it.
        steps: The steps that are read, with the commands of the instant of reading.
    """

    course: Course
    edits: tuple[SpecEdit, ...]
    payload_kg: float
    pause_s: float
    pieces: tuple[Piece, ...]
    moves: tuple[bool, ...]
    steps: tuple[Step, ...]


@dataclass(frozen=True, eq=False)
class Setup:
    """What all campaigns of a session on a robot have in common.

    Attributes:
        compiled: The nominal robot under the servos and the friction of the session.
        spec: The MJCF of the robot from `bare_spec`; to be copied.
        before_end: How long before the end of a control period is read [s], as the environment does.
        legs: The sittings.
    """

    compiled: CompiledRobot
    spec: mujoco.MjSpec
    before_end: float
    legs: tuple[Leg, ...]


@lru_cache(maxsize=4)  # a study runs the same session hundreds of times, and its course is a second's work
def setup_of(robot: Robot, session: Experiment) -> Setup:
    """Return what all campaigns of a session have in common.

    Raises:
        InputError: The session does not fit the robot.
    """
    compiled = compile_robot(robot, edits_of(session))
    session.check(robot, compiled.limits)
    before_end = float(compiled.model.opt.timestep)
    legs = tuple(_leg(one, before_end) for one in sittings_of(session, robot))
    return Setup(compiled, bare_spec(robot), before_end, legs)


def _leg(sitting: Sitting, before_end: float) -> Leg:
    course = course_of(sitting)
    pieces = pieces_of(course)
    moves = tuple(piece.moves(course) for piece in pieces)
    steps = course.steps_at(before_end)
    return Leg(course, sitting.edits, sitting.payload_kg, sitting.pause_s, pieces, moves, steps)


def legs_of(robot: Robot, session: Experiment) -> tuple[Leg, ...]:
    """Return the sittings of a session.

    Raises:
        InputError: It does not fit the robot.
    """
    return setup_of(robot, session).legs


def plan(legs: Sequence[Leg], edits: tuple[SpecEdit, ...], loads: Loads, warm_up: WarmUp) -> tuple[list[Stay], Log]:
    """Return the sittings with their times and conditions, and a log of the steps that will be read.

    Args:
        legs: The sittings.
        edits: Changes of the model that hold throughout; a payload comes before them.
        loads: From nominal loads on the load point to true ones.
        warm_up: How the day goes.
    """
    log, spells, stays, now = Log(), [], [], 0.0
    for i, leg in enumerate(legs):
        course = leg.course
        if i:
            now += leg.pause_s
            spells.append(Spell(leg.pause_s, works=True))
        edges = [*(piece.begins(course) for piece in leg.pieces), course.seconds]
        for moves, first, last in zip(leg.moves, edges[:-1], edges[1:], strict=True):
            spells.append(Spell(last - first, moves, leg.payload_kg))
        stays.append(Stay(course, (*leg.edits, *edits), now, leg.pieces, (), loads))
        log.steps += leg.steps
        log.payload_kg += [leg.payload_kg] * len(course.steps)
        now += course.seconds
    during = iter(warm_up.over(spells))
    for i, stay in enumerate(stays):
        if i:
            next(during)  # the pause
        conditions = [replace(next(during), time_s=time_s) for time_s in _times(stay)]
        stays[i] = replace(stay, conditions=tuple(conditions))
    return stays, log


def _times(stay: Stay) -> Iterator[float]:
    """Yield when each piece of a sitting is read, in the middle, from the start of the campaign [s]."""
    ends, marked = stay.course.ends, stay.course.marked
    for piece in stay.pieces:
        read = marked[(marked >= piece.first) & (marked < piece.last)]
        when = ends[read] if len(read) else ends[piece.first : piece.last]
        yield stay.begin + float(when[0] + when[-1]) / 2
