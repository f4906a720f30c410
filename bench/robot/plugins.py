"""Plugin actuators in an `MjSpec`: their attributes, in an instance of their own or a shared one, and their names."""

from collections.abc import Collection, Mapping, Sequence

import mujoco

from bench.errors import RobotError, unknown_name
from bench.robot.patching.overlay import SpecOverlay

PREFIX = "effect/"  # of the names of all parts that effects add


def attributes_of(spec: mujoco.MjSpec, actuator: str) -> dict[str, str]:
    """Return the attributes of one actuator; of a shared instance, the values that count for this actuator.

    Raises:
        RobotError: There is no such actuator, or it is not a plugin.
    """
    config, index, count = _place(spec, actuator)
    return {key: entry_of(text, index, count) for key, text in config.items()}


def number_of(spec: mujoco.MjSpec, actuator: str, attribute: str) -> float:
    """Return one attribute as a number.

    Raises:
        RobotError: The actuator has not that attribute, or it is not a number.
    """
    return _numbers(actuator, (attribute,), *_place(spec, actuator))[0]


def numbers_of(spec: mujoco.MjSpec, actuators: Sequence[str], attributes: Sequence[str]) -> list[list[float]]:
    """Return some attributes of some actuators as numbers, a row for each actuator.

    Raises:
        RobotError: An actuator has not one of them, or it is not a number.
    """
    users: dict[str, list[str]] = {}
    for one in spec.actuators:
        users.setdefault(one.plugin.name, []).append(one.name)
    return [_numbers(actuator, attributes, *_place(spec, actuator, users)) for actuator in actuators]


def _numbers(
    actuator: str, attributes: Sequence[str], config: Mapping[str, str], index: int, count: int
) -> list[float]:
    found = []
    for attribute in attributes:
        if attribute not in config:
            raise RobotError(f"actuator {actuator!r}: {unknown_name('attribute', attribute, config)}")
        text = entry_of(config[attribute], index, count)
        try:
            found.append(float(text))
        except ValueError as error:
            raise RobotError(f"actuator {actuator!r}: {attribute}: {text!r} is not a number.") from error
    return found


def configure(spec: mujoco.MjSpec, actuator: str, **values: float | str) -> None:
    """Set attributes of one actuator, to full precision; others that share its instance keep theirs.

    Raises:
        RobotError: There is no such actuator, or it is not a plugin.
    """
    config, index, count = _place(spec, actuator)
    for key, value in values.items():
        text = value if isinstance(value, str) else repr(float(value))
        if count > 1:
            # an attribute that nobody had yet is not set for the others; zero is the null value of all that can be left
            # out
            given = config.get(key, "0")
            entries = given.split()
            if len(entries) != count:
                entries = [given] * count
            entries[index] = text
            text = " ".join(entries)
        config[key] = text
    _store(spec, actuator, config)


def added_body(spec: mujoco.MjSpec, name: str) -> mujoco.MjsBody | None:
    """Return the body `effect/name` that an effect added to a spec; None where there is none."""
    return spec.body(PREFIX + name) if PREFIX + name in _names_in(spec) else None


def _names_in(spec: mujoco.MjSpec) -> Collection[str]:
    if isinstance(spec, SpecOverlay):
        return spec.names(("actuator", "joint", "body", "plugin"))
    return {part.name for part in (*spec.actuators, *spec.joints, *spec.bodies, *spec.plugins)}


def unused_name(spec: mujoco.MjSpec, name: str) -> str:
    """Return `effect/name`, with a number behind it where the spec has that name already."""
    taken = _names_in(spec)
    wanted, count = PREFIX + name, 1
    while wanted in taken:
        count += 1
        wanted = f"{PREFIX}{name} {count}"
    return wanted


def name_instances(spec: mujoco.MjSpec) -> None:
    """Name the unnamed plugin instances: MuJoCo 4.0.0 saves no named instance that follows an unnamed one."""
    unnamed = [plugin for plugin in spec.plugins if not plugin.name]
    if not unnamed:
        return
    users = [actuator for actuator in spec.actuators if actuator.plugin.active and not actuator.plugin.name]
    if len(unnamed) != len(users):
        return  # some belong to other parts of the model
    for instance, actuator in zip(unnamed, users, strict=True):  # both in the order of the file
        # its `plugin_name` is left as it is: MuJoCo 4.0.0 writes past the end when that is set here, and dies later
        instance.name = actuator.plugin.name = unused_name(spec, actuator.name)


def entry_of(text: str, index: int, count: int) -> str:
    """Return what a text of an instance that `count` actuators share says of the one at `index`."""
    entries = text.split()
    return entries[index] if count > 1 and len(entries) == count else text


def _place(
    spec: mujoco.MjSpec, actuator: str, users: Mapping[str, list[str]] | None = None
) -> tuple[dict[str, str], int, int]:
    """Return the configuration that an actuator uses, its place among those that share it, and how many they are.

    `users` says which actuators use an instance, where that is known.
    """
    if isinstance(spec, SpecOverlay) and (quickly := spec.use_of(actuator)):
        return quickly
    found = spec.actuator(actuator)
    if found is None or not found.plugin.active:
        raise RobotError(
            unknown_name("plugin actuator", actuator, (one.name for one in spec.actuators if one.plugin.active))
        )
    instance = found.plugin.name
    if not instance:
        return dict(found.plugin.config), 0, 1
    if users is None:
        users = {instance: [one.name for one in spec.actuators if one.plugin.name == instance]}  # of other kinds: ""
    sharing = users[instance]
    return dict(spec.plugin(instance).config), sharing.index(actuator), len(sharing)


def _store(spec: mujoco.MjSpec, actuator: str, config: Mapping[str, str]) -> None:
    if isinstance(spec, SpecOverlay) and spec.configured(actuator, config):
        return
    plugin = spec.actuator(actuator).plugin
    (spec.plugin(plugin.name) if plugin.name else plugin).config = dict(config)
