"""Replay: the model repeats a campaign, and says what every instrument should have shown.

A `World` is the nominal robot with some deviations and some effects. Its prediction is a simulation in MuJoCo each
time; nothing here is a linearisation.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import numpy as np

from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.play import expected
from bench.diagnose.replay.quantities import Quantity, predicted
from bench.diagnose.replay.segments import Segment
from bench.effects.effect import REFERENCE_K, Acting, Conditions, Effect
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot, SpecEdit, compile_spec
from bench.simulate.bare import bare_spec
from bench.simulate.instruments import Reading
from bench.simulate.payload import bolt_on
from bench.simulate.plant import Trace
from bench.simulate.prescribed import Motion, Prescribed


@dataclass(frozen=True)
class World:
    """A hypothesis about robot and instruments.

    Attributes:
        deviations: Nuisance -> value.
        acting: Effects that act.
    """

    deviations: Mapping[Nuisance, float] = field(default_factory=dict)
    acting: tuple[Acting, ...] = ()


NOMINAL = World()


class Replay:
    """A campaign, ready to be repeated by worlds.

    Args:
        compiled: The nominal robot.
        segments: The campaign.
        quantities: What is predicted.
    """

    def __init__(
        self, compiled: CompiledRobot, segments: tuple[Segment, ...], quantities: tuple[Quantity, ...]
    ) -> None:
        self.compiled = compiled
        self.segments = segments
        self.quantities = quantities
        self._spec = bare_spec(compiled.robot)
        self._found: dict[tuple[int, int], Array] = {}  # (segment, number of unknowns) -> where links were last
        self._nominal: list[Trace] = []
        self._nominal = self.traces(NOMINAL)

    @property
    def shape(self) -> tuple[int, int]:
        """Instants that are read, and quantities."""
        return sum(len(segment) for segment in self.segments), len(self.quantities)

    def predict(self, world: World) -> Array:
        """Return what instruments show in a world, shape (T, c), segment after segment.

        Raises:
            ConvergenceError: The model finds no balance.
            RobotError: The effect does not fit the model.
        """
        moves = _changes_robot(world)
        traces = self.traces(world) if moves else self._nominal
        parts = []
        for segment, trace in zip(self.segments, traces, strict=True):
            reading = ideal_reading(self.compiled, trace)
            for acting in world.acting:
                reading = acting.effect.distort(acting.place, acting.values, reading, trace, segment.conditions)
            parts.append(reading)
        reading = Reading.concatenate(parts)
        for nuisance, value in world.deviations.items():
            if nuisance.on_reading:
                reading = nuisance.on_reading(value, reading)
        return predicted(self.quantities, reading)

    def traces(self, world: World) -> list[Trace]:
        """Return the true motion in a world, segment by segment."""
        robots: dict[object, Prescribed] = {}
        with_conditions = any("temperature" in need for acting in world.acting for need in acting.effect.needs)
        traces = []
        for i, segment in enumerate(self.segments):
            conditions = segment.conditions
            key = (conditions.payload_kg, segment.run if with_conditions else "")
            if key not in robots:
                if not with_conditions:
                    conditions = Conditions.reference(self.compiled.n_joints, conditions.payload_kg)
                robots[key] = Prescribed(self._robot(world, conditions))
            motion = _moved(segment.motion, world)
            here = i, robots[key].n_unknowns
            trace, self._found[here] = robots[key].follow(motion, self._found.get(here))  # the next world is similar
            traces.append(expected(robots[key].compiled, trace, is_static=segment.is_static))
        return traces

    @contextmanager
    def unchanged(self) -> Iterator[None]:
        """Let nothing that is simulated meanwhile serve as a first guess later.

        Guesses leave traces in the last digits. What is simulated on several cores would depend on which core was free.
        """
        found = dict(self._found)
        try:
            yield
        finally:
            self._found = found

    def play(self, world: World) -> Array:
        """Return the play of the gears in a world, shape (n,) [rad] or [m].

        Raises:
            RobotError: The effect does not fit the model.
        """
        if not any(acting.effect.scatters for acting in world.acting):
            return self.compiled.play
        return self._robot(World(acting=world.acting), Conditions.reference(self.compiled.n_joints)).play

    def _robot(self, world: World, conditions: Conditions) -> CompiledRobot:
        spec = self._spec.copy()
        return compile_spec(spec, self.compiled.robot, edits_in(world, conditions))


def edits_in(world: World, conditions: Conditions) -> list[SpecEdit]:
    """Return the changes of the model in a world: payload, deviations, effects, in this order."""
    edits: list[SpecEdit] = []
    share = 1.0 + sum(value for nuisance, value in world.deviations.items() if nuisance.scales_payload)
    if conditions.payload_kg:
        edits.append(bolt_on(share * conditions.payload_kg))
    edits += [nuisance.edit(value) for nuisance, value in world.deviations.items() if nuisance.edit]
    for acting in world.acting:
        edit = acting.effect.edit(acting.place, acting.values, conditions)
        if edit:
            edits.append(edit)
    return edits


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


def _changes_robot(world: World) -> bool:
    """Whether a world moves differently from the nominal one, or only reads differently."""
    if any(n.edit or n.scales_wrench or n.scales_payload for n in world.deviations):
        return True
    return any(
        type(acting.effect).edit is not Effect.edit or type(acting.effect).encoder_error is not Effect.encoder_error
        for acting in world.acting
    )


def _moved(motion: Motion, world: World) -> Motion:
    """Return the true motion where the encoders are wrong, and the true load where weights are."""
    share = 1.0 + sum(value for nuisance, value in world.deviations.items() if nuisance.scales_wrench)
    if share != 1.0:
        motion = replace(motion, wrench=share * motion.wrench)
    for acting in world.acting:
        error = acting.effect.encoder_error(acting.place, acting.values, motion.q, motion.velocity)
        if error is not None:
            motion = replace(motion, q=motion.q - error)
    return motion
