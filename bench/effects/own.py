"""A user's own effects: what goes wrong in them is said with file, line and the name of the effect."""

import re
import traceback
from collections.abc import Callable, Iterable, Iterator
from dataclasses import fields
from functools import wraps
from pathlib import Path
from typing import Any, get_args

import numpy as np

from bench.effects.conditions import Conditions
from bench.effects.effect import Between, Effect, Family, Level, Parameter, Place
from bench.effects.followed import Torques
from bench.effects.recorded import Lateness, LogError
from bench.errors import BenchError, InputError
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.patched import Unpatched
from bench.simulate.instruments import Reading

REQUIRED = ("name", "family", "title", "physics", "source", "parameters")
SNAKE_CASE = re.compile(r"[a-z][a-z0-9_]*")  # what stands around a name on a command line has a meaning: = @ :
NUMBERS = ("null", "low", "high")  # of a parameter
CHOICES = {"family": Family, "level": Level, "between": Between}
METHODS = (
    "places",
    "places_in",
    "parameters_at",
    "edit",
    "phase",
    "torques",
    "encoder_error",
    "distort",
    "lateness",
    "log_error",
)
ACTING = ("edit", "torques", "encoder_error", "distort", "lateness", "log_error")  # one of them changes something
TUPLES: dict[str, type] = {"places": Place, "places_in": Place, "parameters_at": Parameter}  # returns tuples of these


class EffectError(InputError):
    """A user's own effect failed at work; other causes must not be named without it."""


def faults_of(kind: type[Effect]) -> list[str]:
    """Return what is wrong with the class attributes of an effect, as sentences."""
    if missing := [name for name in REQUIRED if not hasattr(kind, name)]:
        return [f"set {', '.join(missing)}."]
    found = [f"{name} must be text." for name in REQUIRED[:-1] if not isinstance(getattr(kind, name), str)]
    if not found and not SNAKE_CASE.fullmatch(kind.name):
        found.append(f"name {kind.name!r} must be in snake_case: small letters, digits and _.")
    for name, choices in CHOICES.items():
        if getattr(kind, name) not in get_args(choices):
            found.append(f"{name} {getattr(kind, name)!r} is unknown; choose one of {', '.join(get_args(choices))}.")
    if all(getattr(kind, name) is getattr(Effect, name) for name in ACTING):
        found.append(f"does nothing; give it one of {', '.join(ACTING)}.")
    parameters = kind.parameters
    if not isinstance(parameters, tuple) or not all(isinstance(one, Parameter) for one in parameters):
        found.append("parameters must be a tuple of Parameter; a tuple of one ends with a comma.")
    elif not parameters:
        found.append("parameters is empty; give one at least.")
    else:
        found += [f"parameter {one.name!r}: {fault}" for one in parameters for fault in _faults_of_range(one)]
        names = [one.name for one in parameters]
        found += [f"parameter {name!r} is there twice." for name in dict.fromkeys(names) if names.count(name) > 1]
    if not isinstance(kind.needs, tuple) or not all(isinstance(need, str) for need in kind.needs):
        found.append("needs must be a tuple of text; a tuple of one ends with a comma.")
    elif kind.edit is not Effect.edit and not kind.depends_on_conditions and _needs_temperature(kind):
        found.append("needs a temperature and edits the model: set depends_on_conditions = True.")
    return found


def _faults_of_range(parameter: Parameter) -> Iterator[str]:
    numbers = [getattr(parameter, name) for name in NUMBERS]
    if not all(isinstance(number, int | float) and np.isfinite(number) for number in numbers):
        yield f"{', '.join(NUMBERS)} must be finite numbers."
    elif not parameter.low <= parameter.high:
        yield "low is above high."


def _needs_temperature(kind: type[Effect]) -> bool:
    return any("temperature" in need for need in kind.needs)


def guarded(kind: type[Effect], file: Path) -> Effect:
    """Return a user's effect whose methods say where they failed.

    Args:
        kind: The class.
        file: That defines it.

    Raises:
        InputError: It cannot be made.
    """
    own = {name: getattr(kind, name) for name in METHODS if getattr(kind, name) is not getattr(Effect, name)}
    methods = {name: _guard(method, file, kind.name, name) for name, method in own.items()}
    effect: Effect = _guard(type(kind.__name__, (kind,), methods), file, kind.name, "__init__")()
    return effect


def try_out(effects: Iterable[Effect], compiled: CompiledRobot) -> None:
    """Put effects into the robot once, at a typical size in each place, so that one that fails does so at once.

    Raises:
        EffectError: A method failed.
        RobotError: The changed model does not compile.
    """
    for effect in effects:
        for place in effect.places(compiled):
            values = {one.name: one.typical for one in effect.parameters_at(compiled, place)}
            edit = effect.edit(place, effect.complete(values), Conditions.reference(compiled.n_joints))
            if edit:
                compile_robot(compiled.robot, [edit])


def line_in(file: Path, error: BaseException) -> str:
    """Return the file with the line in which an error arose, "file:12"; without the line where it is elsewhere."""
    names = (str(file), str(file.absolute()))  # Python makes the names of files that it imports absolute
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename in names]
    line = error.lineno if isinstance(error, SyntaxError) and error.filename in names else (lines or [None])[-1]
    return f"{file}:{line}" if line else str(file)


def _guard(call: Callable[..., Any], file: Path, effect: str, method: str) -> Callable[..., Any]:
    """Return a callable that raises `EffectError` whatever goes wrong in it."""

    @wraps(call)
    def guarded_call(*args: Any) -> Any:
        try:
            found = call(*args)
        except BenchError:
            raise  # knows what it says
        except Exception as error:  # a user's code may raise anything
            said = f"{type(error).__name__}: {error}"
            raise EffectError(f"{line_in(file, error)}: effect {effect!r}: {method} raised {said}") from error
        if wrong := _wrong_result(method, args, found):
            raise EffectError(f"{file}: effect {effect!r}: {method} {wrong}")
        if method == "edit" and found:
            return Unpatched(_guard(found, file, effect, "the change from edit"))
        return found

    return guarded_call


def _wrong_result(method: str, args: tuple[Any, ...], found: Any) -> str:
    """Return what is wrong with what a method returned, or nothing."""
    if method in TUPLES and not (isinstance(found, tuple) and all(isinstance(one, TUPLES[method]) for one in found)):
        return f"must return a tuple of {TUPLES[method].__name__}; a tuple of one ends with a comma."
    if method == "edit" and found is not None and not callable(found):
        return "must return a function of spec and robot, or None."
    if method == "lateness" and not isinstance(found, Lateness | None):
        return "must return a Lateness, or None."
    if method == "log_error" and not isinstance(found, LogError | None):
        return "must return a LogError, or None."
    if method == "torques" and found is not None:
        if not isinstance(found, Torques):
            return "must return Torques, or None."
        length = (len(args[3].trace),)
        for side in (found.motor, found.link):
            if np.shape(side) not in ((), length) or not np.all(np.isfinite(side)):
                return f"must return a finite number for each of {length[0]} instants, or one for all."
    if method == "encoder_error" and found is not None:
        shape = np.shape(args[3])
        if np.shape(found) != shape:
            return f"returned shape {np.shape(found)}, expected {shape}."
        if not np.all(np.isfinite(found)):
            return "returned values that are not finite."
    if method == "distort":
        if not isinstance(found, Reading):
            return "must return a Reading; use dataclasses.replace(reading, ...)."
        for field in fields(Reading):
            before, after = getattr(args[3], field.name), getattr(found, field.name)
            if np.shape(after) != np.shape(before):
                return f"returned {field.name} of shape {np.shape(after)}, expected {np.shape(before)}."
            if np.any(np.isnan(after) & ~np.isnan(before)):
                return f"returned {field.name} with values that are not finite."
    return ""
