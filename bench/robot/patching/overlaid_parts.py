"""Parts of an overlaid spec, as an edit sees them: attributes are read from the overlay, and noted there when set."""

from typing import TYPE_CHECKING, Any

from bench.robot.patching.numbers import NotPatchableError
from bench.robot.patching.parts import Add, Handle

if TYPE_CHECKING:
    from bench.robot.patching.overlay import SpecOverlay


class Part:
    """One part of an overlaid spec; attributes are read and set as those of MuJoCo's own."""

    __slots__ = ("handle", "overlay")
    handle: Handle
    overlay: "SpecOverlay"

    def __init__(self, overlay: "SpecOverlay", handle: Handle) -> None:
        object.__setattr__(self, "overlay", overlay)
        object.__setattr__(self, "handle", handle)

    def __getattr__(self, name: str) -> Any:
        return self.overlay.read(self.handle, name)

    def __setattr__(self, name: str, value: Any) -> None:
        self.overlay.write(self.handle, name, value)


class _Carried(Part):
    __slots__ = ()

    @property
    def parent(self) -> Part:
        return self.overlay.part(self.overlay.carrier(self.handle))


class _Body(_Carried):
    __slots__ = ()

    @property
    def joints(self) -> list[Part]:
        return self.overlay.carried(self.handle, "joint")

    @property
    def sites(self) -> list[Part]:
        return self.overlay.carried(self.handle, "site")

    @property
    def bodies(self) -> list[Part]:
        return self.overlay.carried(self.handle, "body")

    def find_all(self, kind: str) -> list[Part]:
        if kind != "body":
            raise NotPatchableError(f"find_all({kind!r})")
        return [*self.bodies, *(below for child in self.bodies for below in child.find_all("body"))]

    def add_body(self, *, name: str, **values: Any) -> Part:
        return self.overlay.add(Add("body", name, self.handle), values)

    def add_joint(self, **values: Any) -> Part:
        return self.overlay.add(Add("joint", values.pop("name", ""), self.handle), values)


class _Tendon(Part):
    __slots__ = ()

    def wrap_joint(self, joint: str, coefficient: float) -> None:
        self.overlay.wrap(self.handle, joint, coefficient)


class _Actuator(Part):
    __slots__ = ()

    @property
    def plugin(self) -> Part:
        return self.overlay.part(Handle("use", self.handle.number))


_CLASSES: dict[str, type[Part]] = {
    "body": _Body,
    "joint": _Carried,
    "site": _Carried,
    "tendon": _Tendon,
    "actuator": _Actuator,
}


def part_of(overlay: "SpecOverlay", handle: Handle) -> Part:
    """Return a part of an overlaid spec, of the class of its kind."""
    return _CLASSES.get(handle.kind, Part)(overlay, handle)
