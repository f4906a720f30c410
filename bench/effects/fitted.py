"""Effects that a robot's figures hold as fitted: from the entries of `fitted.effects` to effects that act, and back."""

from collections.abc import Mapping

import numpy as np

from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Acting, Effect, Place
from bench.effects.learned import Learned, values_of
from bench.effects.learned_readings import (
    IN_ROOM,
    IN_TIME,
    OF_READING,
    UNDER_FORCE,
    LearnedDrift,
    LearnedLoss,
    LearnedMount,
    LearnedRoom,
    LearnedScale,
)
from bench.errors import RobotError, unknown_name
from bench.robot.compiled import CompiledRobot
from bench.robot.fitted import FittedEffect

# Learned errors of readings with what their shapes rest on; learned torques stand in the MJCF.
FORMS: Mapping[type[Learned], tuple[str, ...]] = {
    LearnedScale: ("channel", "largest"),
    LearnedLoss: ("nodes", "stiffness", "torque_constant"),
    LearnedRoom: ("centre", "size"),
    LearnedDrift: ("start",),
    LearnedMount: ("reflector", "largest"),
}
LEARNED = {kind.name: kind for kind in FORMS}
# Names that their parameters may have; those of a loss number its nodes.
PARAMETERS = {LearnedScale: OF_READING, LearnedRoom: IN_ROOM, LearnedDrift: IN_TIME, LearnedMount: UNDER_FORCE}


def fitted_acting(compiled: CompiledRobot) -> tuple[Acting, ...]:
    """Return the effects that a robot's figures hold as fitted, in their order.

    Raises:
        RobotError: An effect, place or parameter is unknown; every fault is listed.
    """
    entries = compiled.robot.figures.fitted.effects
    if not entries:
        return ()
    found, faults = [], []
    for i, entry in enumerate(entries):
        try:
            found.append(acting_of(entry, compiled))
        except RobotError as error:
            faults.append(f"{compiled.robot.figures_file}: fitted.effects[{i}]: {error}")
    if faults:
        raise RobotError(faults)
    return tuple(found)


def acting_of(entry: FittedEffect, compiled: CompiledRobot) -> Acting:
    """Return an entry of `fitted.effects` as an effect that acts on a robot.

    Raises:
        RobotError: Effect, place or parameter is unknown.
    """
    effect = _effect_of(entry, catalogue())
    return Acting(effect, _place_of(entry, effect, compiled), _values_of(entry, effect))


def entry_of(acting: Acting) -> FittedEffect | None:
    """Return an effect as an entry of `fitted.effects`; None where it is neither of the catalogue nor learned."""
    effect, place = acting.effect, acting.place
    where = "robot" if place.kind == "robot" else place.name
    values = {name: float(value) for name, value in acting.values.items()}
    if type(effect) in FORMS:
        form = {name: _plain(getattr(effect, name)) for name in FORMS[type(effect)]}  # type: ignore[index]
        return FittedEffect(effect=effect.name, place=where, values=values, form=form)
    listed = catalogue().get(effect.name)
    if type(listed) is not type(effect):
        return None
    return FittedEffect(effect=effect.name, place=where, values=values, form={})


def _effect_of(entry: FittedEffect, known: Mapping[str, Effect]) -> Effect:
    if entry.effect in known and not entry.form:
        return known[entry.effect]
    if entry.effect not in LEARNED:
        raise RobotError(unknown_name("effect", entry.effect, [*known, *LEARNED]))
    kind = LEARNED[entry.effect]
    names = FORMS[kind]
    if set(entry.form) != set(names):
        raise RobotError(
            f"form of {entry.effect!r}: needs {', '.join(names)}, not {', '.join(entry.form) or 'nothing'}."
        )
    nodes = entry.form.get("nodes", ())
    allowed = PARAMETERS.get(kind) or [f"at_{i + 1}" for i in range(len(nodes) if isinstance(nodes, tuple) else 0)]
    for name in entry.values:
        if name not in allowed:
            raise RobotError(unknown_name(f"parameter of {entry.effect!r}", name, allowed))
    words = [name.replace("_", " ") for name in entry.values]
    form = [np.array(value) if isinstance(value, tuple) else value for value in entry.form.values()]
    parameters = values_of(list(entry.values), words, "", 1.0)  # nobody fits these: unit and prior are not needed
    return kind(parameters, **dict(zip(entry.form, form, strict=True)))


def _place_of(entry: FittedEffect, effect: Effect, compiled: CompiledRobot) -> Place:
    places = effect.places(compiled)
    if isinstance(effect, Learned):
        joints = [drive.joint for drive in compiled.robot.figures.drives]
        places = (WHOLE, *(Place("joint", j, name) for j, name in enumerate(joints)))
    by_name = {place.name or "robot": place for place in places}
    if entry.place not in by_name:
        raise RobotError(unknown_name(f"place of {entry.effect!r} on this robot", entry.place, by_name))
    return by_name[entry.place]


def _values_of(entry: FittedEffect, effect: Effect) -> dict[str, float]:
    names = [parameter.name for parameter in effect.parameters]
    for name in entry.values:
        if name not in names:
            raise RobotError(unknown_name(f"parameter of {entry.effect!r}", name, names))
    return effect.complete(entry.values)


def _plain(value: object) -> str | int | float | tuple[float, ...]:
    if isinstance(value, np.ndarray):
        return tuple(float(x) for x in value)
    return value if isinstance(value, (str, int)) else float(value)  # type: ignore[arg-type]
