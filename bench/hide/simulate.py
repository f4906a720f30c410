"""A session on a robot in which effects act, in their three ways: in the model, before the encoder, in a reading."""

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import replace

import mujoco
import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import Acting
from bench.hide.late import late_in
from bench.hide.plan import Stay
from bench.robot.compiled import SpecEdit, compile_spec
from bench.robot.folder import Robot
from bench.simulate.batch import Course, follow, read_steps, smooth
from bench.simulate.env import CONTROL_PERIOD
from bench.simulate.instruments import Instruments, Reading
from bench.simulate.plant import Left, Plant
from bench.simulate.policy import Step
from bench.simulate.trace import Array, Trace

ITERATIONS = 3  # an encoder's error changes over some arc minutes much less than over a turn


class Plants:
    """The plants of a campaign; one that is like another is made once and set to rest again.

    Args:
        robot: The robot.
        spec: Its model, from `bare_spec`.
        acting: Effects.
        stays: All sittings of the campaign.
        timestep: Integration step [s].
    """

    def __init__(
        self, robot: Robot, spec: mujoco.MjSpec, acting: Sequence[Acting], stays: Sequence[Stay], timestep: float
    ) -> None:
        self._robot, self._spec, self._acting, self._timestep = robot, spec, tuple(acting), timestep
        self._alike: dict[Hashable, Plant] = {}
        self.left: Left | None = None  # by the last sitting
        self._depend_on_temperature = _depends_on_temperature(robot, spec, stays[0], acting)

    def of(self, stay: Stay, conditions: Conditions) -> Plant:
        """Return the plant of a sitting under some conditions; at what it did before, unless conditions change it."""
        phases = tuple(one.effect.phase(one.place, conditions) for one in self._acting)
        key = (stay.edits, conditions.payload_kg, phases)
        if not self._depend_on_temperature and key in self._alike:
            return self._alike[key]
        plant = Plant(self._robot, (*stay.edits, *_edits(self._acting, conditions)), self._timestep, self._spec)
        if not self._depend_on_temperature:
            self._alike[key] = plant
        return plant


def true_trace(plants: Plants, stay: Stay, acting: Sequence[Acting], before_end: float) -> tuple[Trace, Trace]:
    """Return the truth at every instant that is read in a sitting, and the same with what is late as it was before.

    Their time is that of the campaign.

    Args:
        plants: Of the campaign.
        stay: The sitting.
        acting: Effects.
        before_end: How long before the end of a control period is read [s].
    """
    course = stay.course
    start, commands = true_commands(course, acting)
    path = course.path if commands is course.commands else smooth(start, commands)
    wrenches = stay.loads(course.wrenches)
    plant = plants.of(stay, stay.conditions[0])
    plant.arrive(start, stay.begin, plants.left)
    late = late_in(acting)
    parts: list[Trace] = []
    seen: list[Trace] = []
    for i, (piece, (conditions, here)) in enumerate(zip(stay.pieces, stay.read(), strict=True)):
        before, plant = plant, plants.of(stay, conditions) if i else plant
        if plant is not before:
            plant.take_over(before)
        rows, read = slice(piece.first, piece.last), course.marked[here]
        every = np.unique(np.concatenate([read, *(one.periods(read, piece) for one in late)]))
        there = follow(plant, path, piece.first, wrenches[rows], every, before_end, course.waits[rows])
        truth = there[np.searchsorted(every, read)]
        parts.append(truth)
        for one in late:
            truth = one.shown(truth, there, every, read, piece)
        seen.append(truth)
    plants.left = plant.left(stay.begin + course.seconds)
    times = stay.begin + course.ends[course.marked] - before_end
    return replace(Trace.concatenate(parts), time=times), replace(Trace.concatenate(seen), time=times)


def true_commands(course: Course, acting: Iterable[Acting]) -> tuple[Array, Array]:
    """Return where the motors truly go when the servo follows a wrong encoder: start (n,) and commands (P, n) [rad]."""
    acting = tuple(acting)
    asked = np.concatenate([course.start[None], course.commands])
    velocity = np.gradient(asked, CONTROL_PERIOD, axis=0)
    true = asked
    for _ in range(ITERATIONS):
        error = encoder_errors(acting, true, velocity)
        if error is None:
            return course.start, course.commands
        true = asked - error
    return true[0], true[1:]


def encoder_errors(acting: Iterable[Acting], q: Array, velocity: Array) -> Array | None:
    """Return reading minus true angle of all effects together, shape (T, n) [rad]; None where there is none."""
    errors = [one.effect.encoder_error(one.place, one.values, q, velocity) for one in acting]
    known = [error for error in errors if error is not None]
    return np.sum(known, axis=0) if known else None


def read(
    instruments: Instruments,
    acting: Sequence[Acting],
    steps: Sequence[Step],
    trace: Trace,
    late: Trace,
    conditions: Conditions,
) -> Reading:
    """Return what the instruments show at K instants under constant conditions.

    Args:
        instruments: They draw noise.
        acting: Effects.
        steps: The K steps that are read.
        trace: The truth there.
        late: The same with what is late as it was before.
        conditions: All the while.
    """
    error = encoder_errors(acting, trace.q, trace.q_velocity)
    seen = late if error is None else replace(late, q=late.q + error)
    reading = read_steps(instruments, steps, seen)
    reading = replace(reading, gas_temperature=np.full(len(steps), conditions.gas_k))
    for one in acting:
        reading = one.effect.distort(one.place, one.values, reading, trace, conditions)
    return reading


def _edits(acting: Iterable[Acting], conditions: Conditions) -> tuple[SpecEdit, ...]:
    edits = (one.effect.edit(one.place, one.values, conditions) for one in acting)
    return tuple(edit for edit in edits if edit is not None)


def _depends_on_temperature(robot: Robot, spec: mujoco.MjSpec, stay: Stay, acting: Sequence[Acting]) -> bool:
    """Whether the model differs between warm and cold."""
    cold = stay.conditions[0]
    warm = replace(
        cold,
        gear_k=cold.gear_k + 10,
        winding_k=cold.winding_k + 10,
        gas_k=cold.gas_k + 10,
        ambient_k=cold.ambient_k + 10,
    )
    if not _edits(acting, cold):
        return False
    first, second = (_bytes(robot, spec, (*stay.edits, *_edits(acting, during))) for during in (cold, warm))
    return first != second


def _bytes(robot: Robot, spec: mujoco.MjSpec, edits: Sequence[SpecEdit]) -> bytes:
    model = compile_spec(spec.copy(), robot, edits).model
    buffer = np.empty(mujoco.mj_sizeModel(model), dtype=np.uint8)
    mujoco.mj_saveModel(model, None, buffer)
    return buffer.tobytes()
