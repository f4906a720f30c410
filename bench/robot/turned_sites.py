"""How reflectors turn with the joints: what sits off in a nest is fixed to the body that carries the nest."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.robot.compiled import CompiledRobot

Array = NDArray[np.float64]
_Link = tuple[tuple[float, float, float, float], int | None]  # a quaternion that stays, or 0 with the axis of a joint


@dataclass(frozen=True, eq=False)
class TurnedSites:
    """Axes of the bodies that carry the reflectors, by the angles of the joints; r reflectors, n joints.

    Attributes:
        count: Reflectors.
        bodies: Of each body that carries some: which, and what turns its axes, from the base outwards.
    """

    count: int
    bodies: tuple[tuple[NDArray[np.intp], tuple[_Link, ...]], ...]

    @classmethod
    def reflectors_of(cls, compiled: CompiledRobot) -> "TurnedSites":
        """Return those of a robot. A joint that nothing drives counts as at rest."""
        carriers = compiled.model.site_bodyid[compiled.at.reflectors]
        bodies = ((np.flatnonzero(carriers == body), _chain(compiled, int(body))) for body in np.unique(carriers))
        return cls(len(carriers), tuple(bodies))

    def moved(self, theta: Array, offset: Array) -> Array:
        """Return offsets in the base frame, shape (T, r, 3), of those in the axes of the bodies, shape (r, 3).

        Args:
            theta: Shape (T, n) [rad], joint angles.
            offset: Shape (r, 3), in the axes of the body that carries the reflector.
        """
        found = np.zeros((len(theta), self.count, 3))
        for mine, chain in self.bodies:
            if np.any(offset[mine]):
                axes = _axes(chain, np.cos(0.5 * theta.T), np.sin(0.5 * theta.T), np.ones(len(theta)))
                found[:, mine] = np.einsum("ijt,kj->tki", axes, offset[mine])
        return found

    def at(self, theta: Array, offset: Array) -> Array:
        """Return what `moved` does of one instant, shape (r, 3), by floats, which are faster than arrays of one.

        Args:
            theta: Shape (n,) [rad].
            offset: Shape (r, 3), in the axes of the body that carries the reflector.
        """
        found = np.zeros((self.count, 3))
        if np.any(offset):
            halves = [0.5 * angle for angle in theta.tolist()]
            cosines, sines = [cos(half) for half in halves], [sin(half) for half in halves]
            for mine, chain in self.bodies:
                found[mine] = offset[mine] @ _axes(chain, cosines, sines, 1.0).T
        return found


def _chain(compiled: CompiledRobot, body: int) -> tuple[_Link, ...]:
    """Return what turns the axes of a body, from the base outwards; turns that do nothing are left out."""
    model = compiled.model
    column = {int(joint): j for j, joint in enumerate(compiled.at.joint)}
    chain: list[_Link] = []
    while body:
        first = int(model.body_jntadr[body])
        for joint in reversed(range(first, first + int(model.body_jntnum[body]))):
            if joint in column and model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE:
                x, y, z = model.jnt_axis[joint].tolist()
                chain.append(((0.0, x, y, z), column[joint]))
        w, x, y, z = model.body_quat[body].tolist()
        if (x, y, z) != (0.0, 0.0, 0.0):
            chain.append(((w, x, y, z), None))
        body = int(model.body_parentid[body])
    return tuple(reversed(chain))


def _axes(chain: Sequence[_Link], cosines: Any, sines: Any, one: Any) -> Array:
    """Return the rotation at the end of a chain, shape (3, 3, ...), the product of its quaternions.

    Args:
        chain: From the base outwards.
        cosines: Of half of each joint's angle: n floats, or shape (n, T).
        sines: The same.
        one: A float, or shape (T,): 1.
    """
    w, x, y, z = one, 0 * one, 0 * one, 0 * one
    for (a, b, c, d), joint in chain:
        if joint is not None:
            a, sine = cosines[joint], sines[joint]
            b, c, d = sine * b, sine * c, sine * d
        w, x, y, z = (
            w * a - x * b - y * c - z * d,
            w * b + x * a + y * d - z * c,
            w * c - x * d + y * a + z * b,
            w * d + x * c - y * b + z * a,
        )
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
