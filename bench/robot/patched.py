"""Thousands of models of one robot: what an edit changes in numbers is written into a copy of a compiled model.

An edit is given something that looks like the `MjSpec` and notes what the edit does (`patching.overlay`).

- Numbers are written into the model (`patching.numbers`, `patching.plugin_room`): masses, places, stiffness, damping,
  gravity, and the attributes of plugins, thus gas and friction.
- New parts make another structure (`patching.structure`). It is compiled once, and its numbers are written as well:
  torque tables and friction elements, bodies, hinges, more joints on a fixed tendon. With these two every effect of the
  catalogue is patched.
- Whatever else an edit does is compiled as by `compile_spec`. So is every value of which the compiler would make more
  than a copy, and what it may refuse, so that the message is the same. Edits of a user's own are never patched.
"""

from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, replace
from threading import RLock, local
from typing import Any, cast
from weakref import proxy

import mujoco
import numpy as np

from bench.robot.compiled import CompiledRobot, SpecEdit, check_load_body, compile_spec, counterbalance_of
from bench.robot.counterbalance import Counterbalance
from bench.robot.folder import Robot
from bench.robot.patching.numbers import NotPatchableError
from bench.robot.patching.overlay import SpecOverlay
from bench.robot.patching.parts import Add, Blank, Handle, Parts, value_of
from bench.robot.patching.plugin_room import LISTS
from bench.robot.patching.pool import engine
from bench.robot.patching.structure import CompiledStructure
from bench.robot.plugins import entry_of, name_instances
from bench.robot.recent import Recent

MOST_STRUCTURES = 64  # kept compiled, besides the robot's own
MOST_ROBOTS = 128  # remembered: a world asks again for each of its robots, one for each run where these warm up
OF_FRICTION = {  # what a compiled robot has of its friction elements: side, and attribute
    "motor_coulomb": ("motor", "coulomb"),
    "link_coulomb": ("link", "coulomb"),
    "motor_presliding": ("motor", "presliding_stiffness"),
    "link_presliding": ("link", "presliding_stiffness"),
    "motor_rolling": ("motor", "rolling"),
    "motor_drag": ("motor", "drag"),
    "motor_rise": ("motor", "static_rise"),
    "link_rise": ("link", "static_rise"),
    "motor_stribeck": ("motor", "stribeck_velocity"),
    "link_stribeck": ("link", "stribeck_velocity"),
}
MOST_PLACES = 64  # sets of places of which numbers are kept
MOST_WAYS = 8  # first steps, for each of which the last robot's steps are remembered


@dataclass(frozen=True)
class Unpatched:
    """An edit that needs the true `MjSpec`; models with it are compiled.

    Attributes:
        edit: The edit.
    """

    edit: SpecEdit

    def __call__(self, spec: mujoco.MjSpec, robot: Robot) -> None:
        """Change the spec.

        Raises:
            NotPatchableError: It is none, but an overlay.
        """
        if isinstance(spec, SpecOverlay):
            raise NotPatchableError("an edit of a user's own")
        self.edit(spec, robot)


@dataclass(frozen=True)
class Step:
    """Edits that belong together.

    Attributes:
        key: Steps with equal keys do the same.
        edits: Makes them, in order; called where the step is taken.
    """

    key: Hashable
    edits: Callable[[], tuple[SpecEdit, ...]]


class _Way:
    """Steps that one thread took last, and what each of them left noted.

    Args:
        overlay: Nothing is noted on it yet.
    """

    def __init__(self, overlay: SpecOverlay) -> None:
        self._overlay = overlay
        self._taken: list[tuple[Hashable, int]] = []  # keys of steps, and how much was noted after each

    def followed(self, steps: tuple[Step, ...], robot: Robot) -> SpecOverlay:
        """Return what some steps do; those that begin as the last ones did are not taken again."""
        same = 0
        while same < min(len(self._taken), len(steps)) and self._taken[same][0] == steps[same].key:
            same += 1
        del self._taken[same:]
        self._overlay.take_back(self._taken[-1][1] if self._taken else 0)
        for step in steps[same:]:
            for edit in step.edits():
                edit(cast(mujoco.MjSpec, self._overlay), robot)
            self._taken.append((step.key, self._overlay.length))
        return self._overlay


class Structure:
    """A robot whose models are made quickly; several threads may ask at once.

    Args:
        robot: Its folder.
        spec: Its spec; not changed. Models have no keyframes.

    Raises:
        RobotError: As `compile_spec`.
    """

    def __init__(self, robot: Robot, spec: mujoco.MjSpec) -> None:
        self._folder = robot
        self._spec = spec.copy()
        for key in list(self._spec.keys):
            self._spec.delete(key)
        self._nominal = compile_spec(self._spec.copy(), robot)
        self._named = self._spec.copy()
        name_instances(self._named)
        self._parts = Parts(self._named)
        self._lock = RLock()
        self._last = local()
        self._robots: Recent[tuple[Hashable, ...], CompiledRobot] = Recent(MOST_ROBOTS)
        self.of_places: Recent[Hashable, float] = Recent(MOST_PLACES)
        self._values: dict[tuple[Handle, str], Any] = {}
        self._blanks: dict[Add, Blank] = {}
        self._structures: Recent[Hashable, CompiledStructure] = Recent(MOST_STRUCTURES)
        self.names = {kind: [str(part.name) for part in parts] for kind, parts in self._parts.lists.items()}
        self.handles = {
            kind: {name: Handle(kind, i) for i, name in enumerate(names)} for kind, names in self.names.items()
        }
        self.users: dict[str, list[str]] = {name: [] for name in self.names["plugin"]}
        for actuator in self._parts.lists["actuator"]:
            if actuator.plugin.active and actuator.plugin.name:
                self.users[actuator.plugin.name].append(str(actuator.name))
        self.uses = {
            actuator: (self.handles["plugin"][instance], index, len(sharing))
            for instance, sharing in self.users.items()
            for index, actuator in enumerate(sharing)
        }
        self._own = CompiledStructure(robot, self._named, SpecOverlay(proxy(self)))
        self._standing: object = None  # where the parts of the last robot stood, and the gas between them
        self._counterbalance: Counterbalance | None = None
        drives = robot.figures.drives
        self._friction = {drive.motor_friction: ("motor", i) for i, drive in enumerate(drives)}
        self._friction |= {drive.link_friction: ("link", i) for i, drive in enumerate(drives)}

    def robot(self, steps: Iterable[Step]) -> CompiledRobot:
        """Return the robot with some edits, as `compile_spec` would of a copy of the spec.

        The model is the caller's as long as something refers to it; its arrays alone do not count.

        Args:
            steps: Edits in order. Steps with which the last robot of this thread began are not taken again, of those
                robots that had the same first step.

        Raises:
            RobotError: As `compile_spec`.
        """
        steps = tuple(steps)
        return self._robots.get(tuple(step.key for step in steps), lambda: self._made(steps))

    def _made(self, steps: tuple[Step, ...]) -> CompiledRobot:
        try:
            overlay = self._noted(steps)
            with self._lock:
                return self._patched(overlay)
        except NotPatchableError:
            return compile_spec(self._spec.copy(), self._folder, [edit for step in steps for edit in step.edits()])

    def _noted(self, steps: tuple[Step, ...]) -> SpecOverlay:
        """Return what some steps do, which is the caller's until this thread asks for another robot."""
        ways: Recent[Hashable, _Way] = self._last.__dict__.setdefault("ways", Recent(MOST_WAYS))
        way = ways.get(steps[0].key if steps else None, lambda: _Way(SpecOverlay(proxy(self))))
        return way.followed(steps, self._folder)

    def data_for(self, compiled: CompiledRobot) -> mujoco.MjData:
        """Return data for a robot that was made here, as they were left; nobody else has them meanwhile."""
        with self._lock:
            for structure in (self._own, *self._structures.latest()):
                if structure.at is compiled.at:
                    return structure.data_as_left()
        return mujoco.MjData(compiled.model)

    def value(self, handle: Handle, attribute: str) -> Any:
        """Return an attribute of a part of the spec; an array is read-only."""
        key = handle, attribute
        if key not in self._values:
            self._values[key] = value_of(self._parts[handle], attribute)
        return self._values[key]

    def blank(self, operation: Add) -> Blank:
        """Return a part as it is when it was just added."""
        if operation.parent and operation.parent.number >= len(self.names["body"]):
            raise NotPatchableError("a part of an added body")
        key = operation._replace(name="blank")  # what it is called does not count
        with self._lock:
            if key not in self._blanks:
                self._blanks[key] = Blank(self._named, key)
            return self._blanks[key]

    def carrier(self, handle: Handle) -> Handle:
        """Return the body that carries a joint, a site or a body of the spec."""
        return self._own.carrier(handle)

    def carried(self, body: Handle, kind: str) -> tuple[Handle, ...]:
        """Return the joints, sites or bodies of the spec that a body carries itself."""
        if body.number >= len(self.names["body"]):
            return ()
        return self._own.carried(body, kind)

    def wraps(self, tendon: Handle) -> int:
        """Return how many joints or sites a tendon of the spec runs over."""
        return int(self._own.model.tendon_num[self._own.index(tendon)])

    def compiled_with_data(self, overlay: SpecOverlay) -> tuple[mujoco.MjModel, mujoco.MjData]:
        """Return the model with everything that an overlay notes, and fresh data that fit it."""
        with self._lock:
            structure = self._structure(overlay)
            return structure.patched(overlay), structure.fresh_data()

    def _patched(self, overlay: SpecOverlay) -> CompiledRobot:
        structure = self._structure(overlay)
        model, data, at = structure.patched(overlay), structure.data, structure.at
        if overlay.configs and any(
            engine().bench_refuses(model._address, structure.index(handle)) for handle in overlay.configs
        ):
            raise NotPatchableError("attributes that a plugin refuses")
        found = replace(self._with_friction(overlay), model=model, at=at)
        standing = structure, structure.layout, self._gas(overlay)
        if self._standing != standing:
            moves, counterbalance = structure.moves(overlay), self._nominal.counterbalance
            if moves or standing[2]:
                data.qpos[:] = model.qpos0
                mujoco.mj_kinematics(model, data)
                if moves:
                    check_load_body(self._folder, data, at)
                spec = cast(mujoco.MjSpec, overlay)
                counterbalance = counterbalance_of(self._folder, spec, model, data, at)
            self._standing, self._counterbalance = standing, counterbalance
        return replace(found, counterbalance=self._counterbalance)

    def _structure(self, overlay: SpecOverlay) -> CompiledStructure:
        if not overlay.operations:
            return self._own
        lists = tuple(
            (handle, name, config.get(name, "").count(" "))
            for handle, config in overlay.configs.items()
            if not self._is_own(handle)
            for name in LISTS
        )
        key = tuple(overlay.operations), lists
        return self._structures.get(key, lambda: CompiledStructure(self._folder, self._named, overlay))

    def _with_friction(self, overlay: SpecOverlay) -> CompiledRobot:
        """Return the nominal robot with the levels and stiffnesses of the friction elements that an overlay notes."""
        nominal = self._nominal
        if not overlay.configs:
            return nominal
        found: dict[str, Any] = {name: np.array(getattr(nominal, name)) for name in OF_FRICTION}
        for handle, config in overlay.configs.items():
            users = self.users.get(self.names["plugin"][handle.number], []) if self._is_own(handle) else []
            for index, actuator in enumerate(users):
                if actuator in self._friction:
                    side, drive = self._friction[actuator]
                    for name, (of, attribute) in OF_FRICTION.items():
                        if of == side:
                            found[name][drive] = float(entry_of(config.get(attribute, "0"), index, len(users)))
        return replace(nominal, **found)

    def _is_own(self, plugin: Handle) -> bool:
        return plugin.number < len(self.names["plugin"])

    def _gas(self, overlay: SpecOverlay) -> tuple[tuple[tuple[str, str], ...], ...]:
        """Return the texts of the counterbalance, where an overlay notes any."""
        balance = self._folder.figures.counterbalance
        if balance is None:
            return ()
        return tuple(
            tuple(config.items())
            for handle, config in overlay.configs.items()
            if self._is_own(handle) and balance.actuator in self.users.get(self.names["plugin"][handle.number], [])
        )
