"""Attributes of plugin actuators in an `MjSpec`, whether an actuator has an instance of its own or shares one."""

from collections.abc import Mapping, Sequence

import mujoco

from bench.errors import RobotError, unknown_name


def attributes_of(spec: mujoco.MjSpec, actuator: str) -> dict[str, str]:
    """Return the attributes of one actuator; of a shared instance, the values that count for this actuator.

    Raises:
        RobotError: There is no such actuator, or it is not a plugin.
    """
    config, index, count = _place(spec, actuator)
    return {key: _one(text, index, count) for key, text in config.items()}


def number_of(spec: mujoco.MjSpec, actuator: str, attribute: str) -> float:
    """Return one attribute as a number.

    Raises:
        RobotError: The actuator has not that attribute, or it is not a number.
    """
    return numbers_of(spec, actuator, (attribute,))[0]


def numbers_of(spec: mujoco.MjSpec, actuator: str, attributes: Sequence[str]) -> list[float]:
    """Return some attributes as numbers.

    Raises:
        RobotError: The actuator has not one of them, or it is not a number.
    """
    known = attributes_of(spec, actuator)
    found = []
    for attribute in attributes:
        if attribute not in known:
            raise RobotError(f"actuator {actuator!r}: {unknown_name('attribute', attribute, known)}")
        try:
            found.append(float(known[attribute]))
        except ValueError as error:
            raise RobotError(f"actuator {actuator!r}: {attribute}: {known[attribute]!r} is not a number.") from error
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
            entries = [_one(config.get(key, "0"), i, count) for i in range(count)]
            entries[index] = text
            text = " ".join(entries)
        config[key] = text
    _store(spec, actuator, config)


def _place(spec: mujoco.MjSpec, actuator: str) -> tuple[dict[str, str], int, int]:
    """Return the configuration that an actuator uses, its place among those that share it, and how many they are."""
    found = spec.actuator(actuator)
    if found is None or not found.plugin.active:
        raise RobotError(
            unknown_name("plugin actuator", actuator, (one.name for one in spec.actuators if one.plugin.active))
        )
    instance = found.plugin.name
    if not instance:
        return dict(found.plugin.config), 0, 1
    sharing = [one.name for one in spec.actuators if one.plugin.name == instance]  # of other kinds: ""
    return dict(_instance(spec, instance).config), sharing.index(actuator), len(sharing)


def _store(spec: mujoco.MjSpec, actuator: str, config: Mapping[str, str]) -> None:
    plugin = spec.actuator(actuator).plugin
    (_instance(spec, plugin.name) if plugin.name else plugin).config = dict(config)


def _instance(spec: mujoco.MjSpec, name: str) -> mujoco.MjsPlugin:
    return next(plugin for plugin in spec.plugins if plugin.name == name)


def _one(text: str, index: int, count: int) -> str:
    entries = text.split()
    return entries[index] if count > 1 and len(entries) == count else text
