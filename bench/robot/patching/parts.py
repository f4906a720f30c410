"""Parts of an `MjSpec` by their numbers, and operations that give it another structure, to be repeated on a copy."""

from collections.abc import Hashable
from typing import Any, NamedTuple

import mujoco
import numpy as np

from bench.robot.patching.numbers import NotPatchableError

CONFIG = "config"  # attribute of a plugin instance: its texts

# kind of part -> the attribute of MjSpec that lists them
LISTS = {
    "body": "bodies",
    "joint": "joints",
    "site": "sites",
    "tendon": "tendons",
    "actuator": "actuators",
    "plugin": "plugins",
}


class Handle(NamedTuple):
    """A part of a spec: those of the spec first, in its order, then those added.

    Attributes:
        kind: One of `LISTS`; "use" for how an actuator uses a plugin, with the number of the actuator; "option".
        number: From 0.
    """

    kind: str
    number: int


class Parts:
    """The parts of a spec.

    Args:
        spec: Its parts are listed as they are now.
    """

    def __init__(self, spec: mujoco.MjSpec) -> None:
        self._option = spec.option
        self.lists: dict[str, list[Any]] = {kind: list(getattr(spec, name)) for kind, name in LISTS.items()}

    def __getitem__(self, handle: Handle) -> Any:
        if handle.kind == "option":
            return self._option
        if handle.kind == "use":
            return self.lists["actuator"][handle.number].plugin
        return self.lists[handle.kind][handle.number]


class Activate(NamedTuple):
    """A plugin is declared."""

    plugin: str

    def apply(self, spec: mujoco.MjSpec, parts: Parts) -> None:
        """Repeat it."""
        spec.activate_plugin(self.plugin)


class Add(NamedTuple):
    """A part is added; bodies and joints to a body."""

    kind: str
    name: str
    parent: Handle | None = None
    plugin: str = ""

    def apply(self, spec: mujoco.MjSpec, parts: Parts) -> None:
        """Repeat it."""
        if self.kind == "plugin":
            added = spec.add_plugin(name=self.name, plugin_name=self.plugin)
        elif self.kind == "actuator":
            added = spec.add_actuator(name=self.name)
        elif self.kind == "tendon":
            added = spec.add_tendon(name=self.name)
        else:
            assert self.parent
            body = parts[self.parent]
            named = {"name": self.name} if self.name else {}
            added = body.add_body(**named) if self.kind == "body" else body.add_joint(**named)
        parts.lists[self.kind].append(added)


class Assign(NamedTuple):
    """An attribute gets a value."""

    part: Handle
    attribute: str
    value: Hashable

    def apply(self, spec: mujoco.MjSpec, parts: Parts) -> None:
        """Repeat it."""
        value = list(self.value) if isinstance(self.value, tuple) else self.value
        setattr(parts[self.part], self.attribute, value)


class Wrap(NamedTuple):
    """A fixed tendon runs over one more joint; the coefficient is a number of its own."""

    tendon: Handle
    joint: str

    def apply(self, spec: mujoco.MjSpec, parts: Parts) -> None:
        """Repeat it, with the coefficient 1."""
        parts[self.tendon].wrap_joint(self.joint, 1.0)


Operation = Activate | Add | Assign | Wrap


def repeated(spec: mujoco.MjSpec, operations: tuple[Operation, ...]) -> Parts:
    """Apply operations to a spec, which is changed, and return its parts."""
    parts = Parts(spec)
    for operation in operations:
        operation.apply(spec, parts)
    return parts


def hashable(value: Any) -> Hashable:
    """Return a value of an attribute as one that can be part of a key."""
    return tuple(value.tolist()) if isinstance(value, np.ndarray) else value


class Blank:
    """A part as it is when it was just added.

    Args:
        spec: To which it is added; not changed.
        operation: What adds it.
    """

    def __init__(self, spec: mujoco.MjSpec, operation: Add) -> None:
        self._spec = spec.copy()
        self._part = repeated(self._spec, (operation,)).lists[operation.kind][-1]
        self._known: dict[tuple[str, str], Any] = {}

    def value(self, kind: str, attribute: str) -> Any:
        """Return an attribute of it; of the kind "use", of how it uses a plugin."""
        key = kind, attribute
        if key not in self._known:
            self._known[key] = value_of(self._part.plugin if kind == "use" else self._part, attribute)
        return self._known[key]


def value_of(part: Any, attribute: str) -> Any:
    """Return an attribute of a part of a spec; an array as a copy that cannot be written to.

    Raises:
        NotPatchableError: It is no number, text or array.
    """
    value = getattr(part, attribute, None)
    if attribute == CONFIG:
        return dict(value or {})
    if isinstance(value, np.ndarray):
        value = np.array(value)
        value.flags.writeable = False
    elif not isinstance(value, (float, int, str)) and not type(value).__name__.startswith("mjt"):
        raise NotPatchableError(f"{attribute}, which is no number or text")
    return value
