"""A hypothesis about robot and instruments, and what it does to the robot's model and motion."""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.segments import Segment
from bench.effects.conditions import Conditions
from bench.effects.effect import Acting, Effect
from bench.effects.recorded import LogError
from bench.record.campaign import Array
from bench.robot.compiled import SpecEdit
from bench.robot.patched import Step
from bench.simulate.instruments import Reading
from bench.simulate.payload import bolt_on
from bench.simulate.prescribed import Motion


@dataclass(frozen=True)
class World:
    """A hypothesis about robot and instruments.

    Attributes:
        deviations: Nuisance -> value.
        acting: Effects that act.
    """

    deviations: Mapping[Nuisance, float] = field(default_factory=dict)
    acting: tuple[Acting, ...] = ()

    @cached_property
    def is_told_apart(self) -> bool:
        """Whether anything acts in one recording alone."""
        return any(nuisance.recording is not None for nuisance in self.deviations) or any(
            acting.place.recording is not None for acting in self.acting
        )

    @cached_property
    def changes_robot(self) -> bool:
        """Whether it moves differently from the nominal world, or only reads differently."""
        if any(nuisance.moves_robot for nuisance in self.deviations):
            return True
        return any(moves(acting.effect) for acting in self.acting)

    @cached_property
    def key_of_motion(self) -> Hashable:
        """What decides how its robot moves; what only reads differently does not count."""
        off = tuple((nuisance, value) for nuisance, value in self.deviations.items() if nuisance.moves_robot)
        acting = tuple((one.effect, one.place, tuple(one.values.items())) for one in self.acting if moves(one.effect))
        return off, acting

    @cached_property
    def depends_on_conditions(self) -> bool:
        """Whether its robot differs between warm and cold."""
        return any(acting.effect.depends_on_conditions for acting in self.acting)

    @cached_property
    def payload_share(self) -> float:
        """True mass of what is bolted on, over the one that was written down."""
        return 1.0 + sum(value for nuisance, value in self.deviations.items() if nuisance.scales_payload)

    @cached_property
    def figure_steps(self) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
        """What its deviations do to the model: before effects act, and after; the same under all conditions."""
        before, after = (
            tuple(
                Step((nuisance, value), partial(_deviating, nuisance.edit, value))
                for nuisance, value in self.deviations.items()
                if nuisance.edit and value and nuisance.after_effects is is_after
            )
            for is_after in (False, True)
        )
        return before, after

    @property
    def of_machine(self) -> tuple[Acting, ...]:
        """Effects that are the machine's, not a recording's."""
        return tuple(acting for acting in self.acting if acting.effect.level == "machine")

    def read(self, reading: Reading, distorted: Callable[[Reading, Sequence[Acting]], Reading]) -> Reading:
        """Return what its instruments show: the machine's effects, deviations of instruments, errors of a recording.

        What is wrong with a recording comes last: a jump of a current is one of what the sensor shows, scale and all.

        Args:
            reading: What perfect instruments show.
            distorted: Returns a reading in which some effects act.
        """
        reading = distorted(reading, self.of_machine)
        for nuisance, value in self.deviations.items():
            if nuisance.on_reading:
                reading = nuisance.on_reading(value, reading)
        return distorted(reading, [acting for acting in self.acting if acting.effect.level != "machine"])


NOMINAL = World()


def edits_in(world: World, conditions: Conditions) -> list[SpecEdit]:
    """Return the changes of the model in a world: deviations, payload, effects, drifts of the day, in this order."""
    return [edit for step in steps_of(world, conditions) for edit in step.edits()]


def moves(effect: Effect) -> bool:
    """Whether a robot in which an effect acts may move differently; or it only reads differently."""
    own, none = type(effect), Effect
    differ = (
        own.edit is not none.edit,
        own.encoder_error is not none.encoder_error,
        own.log_error is not none.log_error,
    )
    return any(differ)


def steps_of(world: World, conditions: Conditions) -> list[Step]:
    """Return the same, as steps that another world may have in common with this one."""
    payload_kg = world.payload_share * conditions.payload_kg
    figures, drifts = world.figure_steps
    steps = [*figures, Step(payload_kg, lambda: (bolt_on(payload_kg),) if payload_kg else ())]
    for acting in world.acting:
        effect, place = acting.effect, acting.place
        during = conditions.key if effect.depends_on_conditions else (payload_kg, effect.phase(place, conditions))
        key = effect, place, tuple(acting.values.items()), during
        steps.append(Step(key, partial(_acting, acting, conditions)))
    return [*steps, *drifts]


def _deviating(edit: Callable[[float], SpecEdit], value: float) -> tuple[SpecEdit, ...]:
    return (edit(value),)


def _acting(acting: Acting, conditions: Conditions) -> tuple[SpecEdit, ...]:
    edit = acting.effect.edit(acting.place, acting.values, conditions)
    return (edit,) if edit else ()


def model_of(world: World, run: str, recording: str, conditions: Conditions) -> Hashable:
    """Return what decides which model and which loads a world has during a run; equal answers share them.

    No two recordings share a model: each has a clock of its own, which decides on what changes with time.
    """
    phases = tuple(acting.effect.phase(acting.place, conditions) for acting in world.acting)
    is_alone = world.depends_on_conditions or log_error_of(world, run) is not None
    return recording, conditions.payload_kg, run if is_alone else "", phases


def log_error_of(world: World, run: str) -> LogError | None:
    """Return how the truth of a run differs from what was written down of it, None where that is right."""
    found = None
    for acting in world.acting:
        error = acting.effect.log_error(acting.place, acting.values, run)
        if error is not None:
            found = error if found is None else found.with_another(error)
    return found


Rates = Callable[[Acting], tuple[Array, Array]]


def moved(
    motion: Motion, world: World, hung: float = 1.0, rates_of: Rates | None = None
) -> tuple[Motion, Array | None]:
    """Return the true motion where encoders and weights are wrong, and how far off the motors are, shape (T, n).

    Args:
        motion: As it was recorded.
        world: In which it happened.
        hung: True wrench at the load point over the written one.
        rates_of: Returns what an error of the angles adds to speeds and accelerations, shape (T, n) each, as samples of
            the motion tell; None: these are taken as they stand.
    """
    share = hung * (1.0 + sum(value for nuisance, value in world.deviations.items() if nuisance.scales_wrench))
    if share != 1.0:
        motion = replace(motion, wrench=share * motion.wrench)
    shift = None
    for nuisance, value in world.deviations.items():
        if nuisance.on_wrench and value:
            motion = replace(motion, wrench=nuisance.on_wrench(value, motion.wrench))
        if nuisance.encoder is not None and value:
            error = value * np.eye(motion.q.shape[1])[nuisance.encoder]
            motion = replace(motion, q=motion.q - error)
            shift = -error if shift is None else shift - error
    for acting in world.acting:
        error = acting.effect.encoder_error(acting.place, acting.values, motion.q, motion.velocity)
        if error is not None:
            motion = replace(motion, q=motion.q - error)
            if rates_of:
                speed, acceleration = rates_of(acting)
                motion = replace(
                    motion, velocity=motion.velocity - speed, acceleration=motion.acceleration - acceleration
                )
            shift = -error if shift is None else shift - error
    return motion, shift


def rates_along(segments: Sequence[Segment], acting: Acting) -> tuple[Array, Array]:
    """Return what an error of the encoders adds to speeds and accelerations of segments, shape (T, n) each."""
    rates = [one.rates_of(partial(acting.effect.encoder_error, acting.place, acting.values)) for one in segments]
    speed, acceleration = (np.concatenate(parts) for parts in zip(*rates, strict=True))
    return speed, acceleration
