"""What an overlay asks of the spec that it lies on."""

from collections.abc import Hashable, Mapping
from typing import TYPE_CHECKING, Any, Protocol

import mujoco

from bench.robot.patching.parts import Add, Blank, Handle
from bench.robot.recent import Recent

if TYPE_CHECKING:
    from bench.robot.patching.overlay import SpecOverlay


class Below(Protocol):
    """The spec that an overlay lies on."""

    @property
    def names(self) -> Mapping[str, list[str]]:
        """Kind of part -> the names of all of that kind, in the order of the spec."""

    @property
    def handles(self) -> Mapping[str, Mapping[str, Handle]]:
        """Kind of part -> name -> the part."""

    @property
    def uses(self) -> Mapping[str, tuple[Handle, int, int]]:
        """Actuator of a named plugin instance -> the instance, its place among those that share it, their number."""

    @property
    def users(self) -> Mapping[str, list[str]]:
        """Named plugin instance -> the actuators that use it, in the order of the spec."""

    @property
    def of_places(self) -> Recent[Hashable, float]:
        """Numbers that depend on where things are alone, by what they are and what was moved or added."""

    def value(self, handle: Handle, attribute: str) -> Any:
        """Return an attribute of a part; an array is read-only."""

    def blank(self, operation: Add) -> Blank:
        """Return a part as it is when it was just added.

        Raises:
            NotPatchableError: It is added to a part that was added.
        """

    def carrier(self, handle: Handle) -> Handle:
        """Return the body that carries a joint, a site or a body."""

    def carried(self, body: Handle, kind: str) -> tuple[Handle, ...]:
        """Return the joints, sites or bodies that a body carries itself."""

    def wraps(self, tendon: Handle) -> int:
        """Return how many joints or sites a tendon runs over."""

    def compiled_with_data(self, overlay: "SpecOverlay") -> tuple[mujoco.MjModel, mujoco.MjData]:
        """Return the model with everything that an overlay notes, and fresh data that fit it."""
