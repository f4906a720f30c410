"""How sites turn with the joints: what is fixed to the tool, such as a reflector's nest, turns with it."""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.robot.compiled import CompiledRobot

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TurnedSites:
    """Axes of the bodies that carry some sites, by the angles of the joints; r sites, n joints.

    Attributes:
        chains: Of each site, from the base outwards: what turns the axes, a rotation that stays, shape (3, 3), or the
            axis of a hinge, shape (3,), with the index of its joint.
    """

    chains: tuple[tuple[tuple[Array, int | None], ...], ...]

    @classmethod
    def reflectors_of(cls, compiled: CompiledRobot) -> "TurnedSites":
        """Return those of a robot's reflectors. A joint that nothing drives counts as at rest.

        Args:
            compiled: The robot.
        """
        return cls(tuple(_chain(compiled, int(compiled.model.site_bodyid[site])) for site in compiled.at.reflectors))

    def moved(self, theta: Array, offset: Array) -> Array:
        """Return offsets in the base frame, shape (T, r, 3), of those in the axes of the bodies, shape (r, 3).

        Args:
            theta: Shape (T, n) [rad], joint angles.
            offset: Shape (r, 3), in the axes of the body that carries the site.
        """
        found = np.zeros((len(theta), len(self.chains), 3))
        for k, chain in enumerate(self.chains):
            if np.any(offset[k]):
                found[:, k] = _turned(chain, theta, offset[k])
        return found


def _chain(compiled: CompiledRobot, body: int) -> tuple[tuple[Array, int | None], ...]:
    model = compiled.model
    column = {int(joint): j for j, joint in enumerate(compiled.at.joint)}
    chain: list[tuple[Array, int | None]] = []
    while body:
        first = int(model.body_jntadr[body])
        for joint in reversed(range(first, first + int(model.body_jntnum[body]))):
            if joint in column and model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE:
                chain.append((model.jnt_axis[joint].copy(), column[joint]))
        matrix = np.empty(9)
        mujoco.mju_quat2Mat(matrix, model.body_quat[body])
        chain.append((matrix.reshape(3, 3), None))
        body = int(model.body_parentid[body])
    return tuple(reversed(chain))


def _turned(chain: tuple[tuple[Array, int | None], ...], theta: Array, offset: Array) -> Array:
    """Return an offset, shape (T, 3), after a chain of turns; the outermost turns it first (Rodrigues)."""
    found = np.tile(offset, (len(theta), 1))
    for turn, joint in reversed(chain):
        if joint is None:
            found = found @ turn.T
        else:
            cosine, sine = np.cos(theta[:, joint, None]), np.sin(theta[:, joint, None])
            along = (found @ turn)[:, None] * turn
            found = along + cosine * (found - along) + sine * np.cross(turn, found)
    return found
