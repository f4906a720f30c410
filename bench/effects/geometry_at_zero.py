"""The geometry of a spec with all joints at zero, for edits that need to know where things are."""

import mujoco
import numpy as np

from bench.effects.effect import Array
from bench.errors import RobotError
from bench.robot.patching.overlay import SpecOverlay
from bench.robot.plain_words import plain_words


class AtZero:
    """A compiled copy of a spec, at its zero.

    Args:
        spec: It is not changed.

    Raises:
        RobotError: The engine refuses it, for an edit before has left what no robot has.
    """

    def __init__(self, spec: mujoco.MjSpec) -> None:
        try:
            self.model, self.data = _compiled(spec)
        except ValueError as error:
            raise RobotError(plain_words(error)) from error
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_tendon(self.model, self.data)

    def anchor(self, joint: str) -> Array:
        """Return where a joint is, shape (3,) [m], world frame."""
        return np.array(self.data.xanchor[self.model.joint(joint).id])

    def axis(self, joint: str) -> Array:
        """Return the direction of a joint's axis, shape (3,), world frame."""
        return np.array(self.data.xaxis[self.model.joint(joint).id])

    def site(self, name: str) -> Array:
        """Return where a site is, shape (3,) [m], world frame."""
        return np.array(self.data.site_xpos[self.model.site(name).id])

    def length(self, tendon: str) -> float:
        """Return the length of a tendon [m]."""
        return float(self.data.ten_length[self.model.tendon(tendon).id])

    def ends(self, tendon: str, joint: str) -> tuple[str, str]:
        """Return the names of the end sites of a tendon: the one that a joint leaves in place, and the one it moves."""
        first = self.model.tendon_adr[self.model.tendon(tendon).id]
        sites = [self.model.site(int(i)) for i in self.model.wrap_objid[first : first + 2]]
        moved = int(self.model.joint(joint).bodyid[0])
        sites.sort(key=lambda site: self._is_below(int(site.bodyid[0]), moved))
        return str(sites[0].name), str(sites[1].name)

    def direction_in_body_of_site(self, site: str, direction: Array) -> Array:
        """Turn a direction of the world frame into the frame of the body that carries a site, shape (3,)."""
        return self._rotation(int(self.model.site(site).bodyid[0])).T @ direction

    def point_in(self, body: str, point: Array) -> Array:
        """Turn a point of the world frame into the frame of a body, shape (3,) [m]."""
        found = self.model.body(body).id
        return np.array(self._rotation(found).T @ (point - self.data.xpos[found]))

    def direction_in(self, body: str, direction: Array) -> Array:
        """Turn a direction of the world frame into the frame of a body, shape (3,)."""
        return self._rotation(self.model.body(body).id).T @ direction

    def body_of(self, joint: str) -> str:
        """Return the name of the body that a joint moves."""
        return str(self.model.body(int(self.model.joint(joint).bodyid[0])).name)

    def _rotation(self, body: int) -> Array:
        return np.array(self.data.xmat[body]).reshape(3, 3)

    def _is_below(self, body: int, other: int) -> bool:
        while body and body != other:
            body = int(self.model.body_parentid[body])
        return body == other


def length_at_zero(spec: mujoco.MjSpec, tendon: str) -> float:
    """Return the length of a tendon of a spec [m]; where things are is the same in most robots that a fit tries.

    Raises:
        RobotError: As `AtZero`.
    """

    def length() -> float:
        return AtZero(spec).length(tendon)

    return spec.of_places(tendon, length) if isinstance(spec, SpecOverlay) else length()


def across(axis: Array) -> tuple[Array, Array]:
    """Return two unit vectors that stand at right angles to an axis and to each other."""
    first = np.eye(3)[int(np.argmin(np.abs(axis)))]
    first = first - axis * (first @ axis) / (axis @ axis)
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    return first, second / np.linalg.norm(second)


def _compiled(spec: mujoco.MjSpec) -> tuple[mujoco.MjModel, mujoco.MjData]:
    if isinstance(spec, SpecOverlay):
        return spec.compiled_with_data()
    copy = spec.copy()
    for key in list(copy.keys):
        copy.delete(key)  # another edit may have changed the number of joints
    model = copy.compile()
    return model, mujoco.MjData(model)
