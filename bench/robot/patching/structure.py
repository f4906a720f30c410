"""A structure of a robot's model, compiled once; what edits change in its numbers is written into copies of it."""

import copy
from collections.abc import Mapping
from functools import partial
from typing import Any

import mujoco
import numpy as np

from bench.robot.addresses import addresses_of
from bench.robot.checks import faulty_roles
from bench.robot.folder import Robot
from bench.robot.patching.numbers import PATCHES, UNSET_LENGTH, NotPatchableError, Patch, set_frames
from bench.robot.patching.overlay import SpecOverlay
from bench.robot.patching.parts import Add, Handle, repeated
from bench.robot.patching.plugin_room import LAWS, padded, widths, write
from bench.robot.patching.pool import Pool, engine


class CompiledStructure:
    """One structure.

    Attributes:
        model, data, at: As it was compiled.
        layout: Models that were patched while it stayed the same differ in nothing but friction, stiffness and gravity.

    Args:
        robot: The folder.
        spec: With every plugin instance named; not changed.
        overlay: What makes the structure of it.

    Raises:
        NotPatchableError: It does not compile, or is not this robot.
    """

    def __init__(self, robot: Robot, spec: mujoco.MjSpec, overlay: SpecOverlay) -> None:
        self._spec = spec.copy()
        self._parts = repeated(self._spec, tuple(overlay.operations))
        self._rooms: dict[Handle, dict[str, int]] = {}
        tendons = [str(tendon.name) for tendon in self._spec.tendons]
        # one that was named afterwards (`name_instances`) does not say itself which plugin it is of
        used = {part.plugin.name: part.plugin.plugin_name for part in self._spec.actuators if part.plugin.active}
        for instance in overlay.all("plugin"):
            if instance.name and (law := instance.plugin_name or used.get(instance.name, "")) in LAWS:
                config = overlay.texts_to_begin_with(instance.handle)
                room = widths(law, config, len(overlay.users_of(instance.name)), tendons)
                self._rooms[instance.handle] = room
                self._parts[instance.handle].config = padded(config, room)
        # hinges without armature and stiffness would make MuJoCo warn of a singular inertia
        hinged = any(isinstance(done, Add) and done.kind == "joint" for done in overlay.operations)
        self._begun = {key: value for key, value in overlay.numbers.items() if hinged and key[0].kind == "joint"}
        for (handle, attribute), value in self._begun.items():
            setattr(self._parts[handle], attribute, value)
        try:
            self.model = self._spec.compile()
        except ValueError as error:
            raise NotPatchableError(str(error)) from error
        if any(faulty_roles(robot, self.model)):
            raise NotPatchableError("a part that does not play its role")
        self.at = addresses_of(robot, self.model)
        self.data = mujoco.MjData(self.model)
        self._models = Pool(partial(copy.copy, self.model))
        self._data = Pool(partial(mujoco.MjData, self.model))
        self._indices: dict[Handle, int] = {}
        self._carried: dict[tuple[Handle, str], list[Handle]] = {}
        self._places: dict[tuple[Handle, str], tuple[Patch, int]] = {}
        self._last = copy.copy(self.model)  # the last one of which all numbers were written, and these
        self._last_numbers: dict[tuple[Handle, str], Any] | None = None
        self.layout = 0
        compiler = self._spec.compiler
        self._copies_masses = not (
            compiler.boundmass or compiler.boundinertia or compiler.balanceinertia or compiler.settotalmass > 0
        )
        self._derives_inertia = bool(np.isnan(self._spec.stat.meaninertia))
        lengths = np.array([tendon.springlength[0] for tendon in self._spec.tendons])
        is_spatial = self.model.wrap_type[self.model.tendon_adr] != int(mujoco.mjtWrap.mjWRAP_JOINT)
        self._relaxed = np.flatnonzero((lengths == UNSET_LENGTH) & is_spatial)
        self._numbers = {
            kind: {int(part.id): number for number, part in enumerate(parts)}
            for kind, parts in self._parts.lists.items()
            if kind == "body"
        }

    def patched(self, overlay: SpecOverlay) -> mujoco.MjModel:
        """Return a copy of the model with the numbers and texts that an overlay notes.

        Raises:
            NotPatchableError: A number that the compiler did not copy, or would not.
        """
        model = self._models.take()
        numbers = overlay.numbers
        if self._begun:
            numbers = {key: overlay.read(*key) for key in self._begun} | numbers
        changed = self._changed(numbers)
        if changed is None:
            self._write_all(model, numbers)
        else:
            engine().mj_copyModel(model._address, self._last._address)
            for key in changed:
                patch, index = self._place(key)
                patch.write(model, index, numbers[key])
        for handle, config in overlay.configs.items():
            if handle not in self._rooms:
                raise NotPatchableError("attributes of a plugin that is not of the bench")
            write(model, self.index(handle), config, self._rooms[handle])
        return model

    def _changed(self, numbers: Mapping[tuple[Handle, str], Any]) -> list[tuple[Handle, str]] | None:
        """Return which numbers are others than those that were all written last; None: all have to be written.

        Runs of a campaign differ in temperatures, and thus in friction: nothing else of the model depends on that.
        """
        last = self._last_numbers
        if last is None or len(last) != len(numbers):
            return None
        changed = []
        for key, value in numbers.items():
            if key not in last:
                return None
            before = last[key]
            if before is value or np.array_equal(before, value):
                continue
            patch, _ = self._place(key)
            if patch.derives or patch.moves:
                return None
            changed.append(key)
        return changed

    def _write_all(self, model: mujoco.MjModel, numbers: Mapping[tuple[Handle, str], Any]) -> None:
        """Write numbers into a copy of the compiled model, and what MuJoCo derives from them."""
        self._last_numbers = None  # in case that one cannot be written
        engine().mj_copyModel(model._address, self.model._address)
        bodies: set[int] = set()
        sites: set[int] = set()
        derives = moves = False
        for key, value in numbers.items():
            patch, index = self._place(key)
            patch.write(model, index, value)
            derives, moves = derives or patch.derives, moves or patch.moves
            handle, attribute = key
            if attribute == "ipos":
                bodies.add(index)
            elif handle.kind == "site":
                sites.add(index)
        if bodies or sites:
            set_frames(model, bodies, sites)
        if derives:
            mujoco.mj_setConst(model, self.data)
            if self._derives_inertia:
                model.stat.meaninertia = model.dof_M0.mean()  # as the compiler does
        if moves:
            self._relax(model)
        engine().mj_copyModel(self._last._address, model._address)
        self._last_numbers = dict(numbers)
        self.layout += 1

    def data_as_left(self) -> mujoco.MjData:
        """Return data that fit the model and that nobody else holds; whoever takes them resets them."""
        return self._data.take()

    def fresh_data(self) -> mujoco.MjData:
        """Return the same, just reset."""
        data = self.data_as_left()
        mujoco.mj_resetData(self.model, data)
        return data

    def moves(self, overlay: SpecOverlay) -> bool:
        """Whether bodies or points may be elsewhere than in the robot's own model."""
        return any(isinstance(done, Add) and done.kind in ("body", "joint") for done in overlay.operations) or any(
            self._place(key)[0].moves for key in overlay.numbers
        )

    def index(self, handle: Handle) -> int:
        """Return the id of a part in the model."""
        found = self._indices.get(handle)
        if found is None:
            part = self._parts[handle]
            if handle.kind == "plugin":
                found = int(mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_PLUGIN, part.name))
            else:
                found = 0 if handle.kind == "option" else int(part.id)
            self._indices[handle] = found
        return found

    def carrier(self, handle: Handle) -> Handle:
        """Return the body that carries a body, a joint or a site."""
        carriers = {"body": self.model.body_parentid, "joint": self.model.jnt_bodyid, "site": self.model.site_bodyid}
        return Handle("body", self._numbers["body"][int(carriers[handle.kind][self.index(handle)])])

    def carried(self, body: Handle, kind: str) -> tuple[Handle, ...]:
        """Return the joints, sites or bodies that a body carries itself."""
        if not self._carried:
            for found in ("body", "joint", "site"):
                for number in range(found == "body", len(self._parts.lists[found])):  # the world is carried by nothing
                    handle = Handle(found, number)
                    self._carried.setdefault((self.carrier(handle), found), []).append(handle)
        return tuple(self._carried.get((body, kind), ()))

    def _place(self, key: tuple[Handle, str]) -> tuple[Patch, int]:
        """Return how an attribute of a part is written, and the part's id.

        Raises:
            NotPatchableError: The compiled model does not hold what the spec says of it.
        """
        found = self._places.get(key)
        if found is None:
            handle, attribute = key
            found = PATCHES[handle.kind, attribute.partition(" ")[0]], self.index(handle)
            given: Any = None if attribute.startswith("wrap") else getattr(self._parts[handle], attribute)
            if not found[0].held(self.model, found[1], given):
                raise NotPatchableError(f"{attribute} of a {handle.kind}, which the compiler did not copy")
            if handle.kind == "body" and not self._copies_masses:
                raise NotPatchableError("masses that the compiler changes")
            self._places[key] = found
        return found

    def _relax(self, model: mujoco.MjModel) -> None:
        """Give spatial tendons without a spring length of their own the one at which joint springs are relaxed."""
        data, relaxed = self.data, self._relaxed
        data.qpos[:] = model.qpos_spring
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_tendon(model, data)
        model.tendon_lengthspring[relaxed] = data.ten_length[relaxed, None]
