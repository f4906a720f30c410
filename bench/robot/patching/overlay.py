"""What looks like an `MjSpec` to an edit, and notes what the edit does instead of doing it.

Numbers that a compiled model can take are noted as numbers. Everything else is an operation that makes another
structure: parts added, names, kinds. Both are read back as if they had been done. The spec below is never changed, and
an array that an edit reads cannot be written to in place.
"""

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import mujoco
import numpy as np

from bench.robot.patching.below import Below
from bench.robot.patching.journal import Journal
from bench.robot.patching.numbers import PATCHES, NotPatchableError
from bench.robot.patching.overlaid_parts import Part, part_of
from bench.robot.patching.parts import CONFIG, LISTS, Activate, Add, Assign, Blank, Handle, Operation, Wrap, hashable

UNNAMED = "texts of a plugin instance without a name"


class SpecOverlay:
    """Edits of a spec, noted.

    Attributes:
        operations: What makes another structure, in order.
        numbers: (part, attribute) -> value that a compiled model can take.
        configs: Plugin instance -> its texts, of those that were set.

    Args:
        below: The structure; it is not changed.
    """

    keys: tuple[()] = ()  # a structure has none: another number of joints would not fit them

    def __init__(self, below: Below) -> None:
        self._below = below
        self.operations: list[Operation] = []
        self.numbers: dict[tuple[Handle, str], Any] = {}
        self.configs: dict[Handle, dict[str, str]] = {}
        self._assigned: dict[tuple[Handle, str], Any] = {}
        self._names: dict[str, Sequence[str]] = dict(below.names)
        self._carriers: dict[Handle, Handle] = {}
        self._blanks: dict[Handle, Blank] = {}
        self._parts: dict[Handle, Part] = {}
        self._wraps: dict[Handle, int] = {}
        self._shared_anew: list[Handle] = []  # for which an actuator may use other texts, or share them with others
        self._journal = Journal()

    @property
    def length(self) -> int:
        """How much was noted so far."""
        return len(self._journal)

    def take_back(self, length: int) -> None:
        """Forget what was noted since the length was this one."""
        self._journal.take_back(length)

    def compiled_with_data(self) -> tuple[mujoco.MjModel, mujoco.MjData]:
        """Return the model with everything that was noted so far, and fresh data for it."""
        return self._below.compiled_with_data(self)

    def of_places(self, what: Hashable, make: Callable[[], float]) -> float:
        """Return a number that depends on where things are and on nothing else, made anew where that was not kept.

        Args:
            what: Tells it from others.
            make: Makes it.
        """
        moved = tuple(
            (*key, np.asarray(value).tobytes())
            for key, value in self.numbers.items()
            if PATCHES[key[0].kind, key[1].partition(" ")[0]].moves
        )
        return self._below.of_places.get((what, tuple(self.operations), moved), make)

    @property
    def option(self) -> Part:
        """The physics options."""
        return self.part(Handle("option", 0))

    def activate_plugin(self, name: str) -> None:
        """Note a plugin that is declared."""
        operation = Activate(name)
        if operation not in self.operations:
            self._journal.append(self.operations, operation)

    def add_plugin(self, *, name: str, plugin_name: str, **values: Any) -> Part:
        """Note a plugin instance that is added."""
        return self.add(Add("plugin", name, None, plugin_name), values)

    def add_actuator(self, *, name: str, **values: Any) -> Part:
        """Note an actuator that is added."""
        return self.add(Add("actuator", name), values)

    def add_tendon(self, *, name: str, **values: Any) -> Part:
        """Note a tendon that is added."""
        return self.add(Add("tendon", name), values)

    def add(self, operation: Add, values: Mapping[str, Any]) -> Part:
        """Note a part that is added, with values of its attributes, and return it."""
        names, blank = self._names[operation.kind], self._below.blank(operation)
        handle = Handle(operation.kind, len(names))
        self._journal.put(self._names, operation.kind, [*names, operation.name])
        self._journal.append(self.operations, operation)
        if operation.parent:
            self._journal.put(self._carriers, handle, operation.parent)
        self._journal.put(self._blanks, handle, blank)
        if operation.kind == "actuator":
            self._journal.put(self._blanks, Handle("use", handle.number), blank)
        part = self.part(handle)
        for attribute, value in values.items():
            setattr(part, attribute, value)
        return part

    def wrap(self, tendon: Handle, joint: str, coefficient: float) -> None:
        """Note a joint that a fixed tendon runs over, too."""
        first = 0 if tendon in self._blanks else self._below.wraps(tendon)
        index = self._wraps.get(tendon, first)
        self._journal.put(self._wraps, tendon, index + 1)
        self._journal.append(self.operations, Wrap(tendon, joint))
        self._journal.put(self.numbers, (tendon, f"wrap {index}"), (index, coefficient))

    def part(self, handle: Handle) -> Part:
        """Return a part, always the same object for the same part."""
        found = self._parts.get(handle)
        if found is None:
            found = self._parts[handle] = part_of(self, handle)
        return found

    def named(self, kind: str, name: str) -> Part | None:
        """Return a part by its name, None where there is none."""
        names = self._names[kind]
        if names is self._below.names[kind]:
            handle = self._below.handles[kind].get(name)
            return None if handle is None else self.part(handle)
        return self.part(Handle(kind, names.index(name))) if name in names else None

    def all(self, kind: str) -> list[Part]:
        """Return all parts of a kind: those of the spec, then those added."""
        return [self.part(Handle(kind, i)) for i in range(len(self._names[kind]))]

    def users_of(self, instance: str) -> list[str]:
        """Return the names of the actuators that use a named plugin instance, in order."""
        if instance in self._below.users and not self._shared_anew:
            return self._below.users[instance]
        return [one.name for one in self.all("actuator") if one.plugin.name == instance]

    def use_of(self, actuator: str) -> tuple[dict[str, str], int, int] | None:
        """Return the texts that an actuator of the spec uses, its place among those that share them, and their number.

        None where that takes a look at every actuator.
        """
        found = self._below.uses.get(actuator)
        if found is None or self._shared_anew:
            return None
        handle, index, count = found
        return dict(self.read(handle, CONFIG)), index, count

    def configured(self, actuator: str, config: Mapping[str, str]) -> bool:
        """Note the texts that an actuator of the spec uses; whether that was possible without a look at the others."""
        found = self._below.uses.get(actuator)
        if found is None or self._shared_anew:
            return False
        self._journal.put(self.configs, found[0], dict(config))
        return True

    def texts_to_begin_with(self, plugin: Handle) -> Mapping[str, str]:
        """Return the texts of a plugin instance before any edit: those of the spec, or those it was added with."""
        found: Mapping[str, str]
        if plugin.number < len(self._below.names["plugin"]):
            found = self._below.value(plugin, CONFIG)
        else:
            found = self.configs.get(plugin, {})
        return found

    def names(self, kinds: Iterable[str]) -> set[str]:
        """Return the names of all parts of some kinds."""
        return set().union(*(self._names[kind] for kind in kinds))

    def carrier(self, handle: Handle) -> Handle:
        """Return the body that carries a part."""
        return self._carriers.get(handle) or self._below.carrier(handle)

    def carried(self, body: Handle, kind: str) -> list[Part]:
        """Return the parts of a kind that a body carries itself."""
        added = [handle for handle, carrier in self._carriers.items() if carrier == body and handle.kind == kind]
        return [self.part(handle) for handle in (*self._below.carried(body, kind), *added)]

    def read(self, handle: Handle, attribute: str) -> Any:
        """Return an attribute of a part with everything that was noted."""
        key = handle, attribute
        if key in self.numbers:
            return self.numbers[key]
        if key in self._assigned:
            return self._assigned[key]
        if attribute == CONFIG:
            if handle.kind != "plugin":
                raise NotPatchableError(UNNAMED)
            if handle not in self.configs and handle not in self._blanks:
                return self._below.value(handle, CONFIG)
            return self.configs.get(handle, {})
        if attribute == "name" and handle.kind != "use":
            return self._names[handle.kind][handle.number]
        blank = self._blanks.get(handle)
        return blank.value(handle.kind, attribute) if blank else self._below.value(handle, attribute)

    def write(self, handle: Handle, attribute: str, value: Any) -> None:
        """Note a new value of an attribute."""
        if attribute == CONFIG:
            if handle.kind != "plugin":
                raise NotPatchableError(UNNAMED)
            self._journal.put(self.configs, handle, dict(value))
            return
        current = self.read(handle, attribute)
        known = (handle.kind, attribute) in PATCHES
        if isinstance(current, np.ndarray):
            value = np.array(value, dtype=current.dtype)
            value.flags.writeable = False
            if value.shape != current.shape:
                raise NotPatchableError(f"{attribute} of another shape")
            if value.tobytes() == current.tobytes():
                return
            if current[0] != current[0]:  # nan: not defined
                if value[0] != value[0]:
                    return
                known = False
        elif value == current:
            return
        if known:
            self._journal.put(self.numbers, (handle, attribute), value)
            return
        if handle.kind in _SHARING and (
            handle.number < len(self._below.names[_SHARING[handle.kind]]) or value in self._below.users
        ):
            self._journal.append(self._shared_anew, handle)
        if attribute == "name" and handle.kind != "use":
            names = list(self._names[handle.kind])
            names[handle.number] = value
            self._journal.put(self._names, handle.kind, names)
        else:
            self._journal.put(self._assigned, (handle, attribute), value)
        self._journal.append(self.operations, Assign(handle, attribute, hashable(value)))

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in _OWN:
            raise NotPatchableError(f"MjSpec.{name}")
        object.__setattr__(self, name, value)

    def __getattr__(self, name: str) -> Any:
        if name in LISTS:
            return partial(self.named, name)
        kind = _LISTED.get(name)
        if kind:
            return self.all(kind)
        raise NotPatchableError(f"MjSpec.{name}")


_OWN = frozenset(
    {"operations", "numbers", "configs", "_below", "_assigned", "_names", "_carriers", "_blanks", "_parts", "_wraps"}
    | {"_shared_anew", "_journal"}
)  # what an overlay itself holds
_SHARING = {"use": "actuator", "actuator": "actuator", "plugin": "plugin"}  # parts that say whose texts are whose
_LISTED = {plural: kind for kind, plural in LISTS.items()}
