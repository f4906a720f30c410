"""How sites turn with the joints: what is fixed to the tool, such as a reflector's nest, turns with it."""

from dataclasses import dataclass
from functools import cached_property
from math import cos, sin

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.robot.compiled import CompiledRobot

Array = NDArray[np.float64]
_Chain = tuple[tuple[Array, int | None], ...]
_Four = tuple[float, float, float, float]
_Quaternions = tuple[tuple[_Four, int | None], ...]  # the rotation that stays, or 0 and the axis of a hinge


@dataclass(frozen=True, eq=False)
class TurnedSites:
    """Axes of the bodies that carry some sites, by the angles of the joints; r sites, n joints.

    Attributes:
        chains: Of each site, from the base outwards: what turns the axes, a rotation that stays, shape (3, 3), or the
            axis of a hinge, shape (3,), with the index of its joint.
    """

    chains: tuple[_Chain, ...]

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

    def at(self, theta: Array, offset: Array) -> Array:
        """Return what `moved` does of one instant, shape (r, 3), for angles of shape (n,); several times faster.

        Args:
            theta: Shape (n,) [rad].
            offset: Shape (r, 3), in the axes of the body that carries the site.
        """
        found = np.zeros((len(self.chains), 3))
        if not np.any(offset):
            return found
        angles = theta.tolist()
        for sites, chain in self._of_bodies:
            w, x, y, z = 1.0, 0.0, 0.0, 0.0
            for (a, b, c, d), joint in chain:
                if joint is not None:  # about the axis (b, c, d)
                    half = 0.5 * angles[joint]
                    a, sine = cos(half), sin(half)
                    b, c, d = sine * b, sine * c, sine * d
                w, x, y, z = (
                    w * a - x * b - y * c - z * d,
                    w * b + x * a + y * d - z * c,
                    w * c - x * d + y * a + z * b,
                    w * d + x * c - y * b + z * a,
                )
            mujoco.mju_quat2Mat(matrix := np.empty(9), np.array([w, x, y, z]))
            found[sites] = offset[sites] @ matrix.reshape(3, 3).T
        return found

    @cached_property
    def _of_bodies(self) -> tuple[tuple[list[int], _Quaternions], ...]:
        """Sites of each body, with its chain: quaternions in the place of matrices, neighbours as one."""
        found: list[tuple[list[int], _Quaternions]] = []
        for k, chain in enumerate(self.chains):
            same = [sites for sites, _ in found if _are_alike(self.chains[sites[0]], chain)]
            if same:
                same[0].append(k)
            else:
                found.append(([k], _in_quaternions(chain)))
        return tuple(found)


def _are_alike(one: _Chain, other: _Chain) -> bool:
    return len(one) == len(other) and all(
        a == b and np.array_equal(turn, own) for (turn, a), (own, b) in zip(one, other, strict=True)
    )


def _in_quaternions(chain: _Chain) -> _Quaternions:
    found: list[tuple[_Four, int | None]] = []
    still = np.eye(3)
    for turn, joint in chain:
        if joint is None:
            still = still @ turn
            continue
        if not np.array_equal(still, np.eye(3)):
            found.append((_quaternion(still), None))
            still = np.eye(3)
        x, y, z = (turn / np.linalg.norm(turn)).tolist()
        found.append(((0.0, x, y, z), joint))
    return (*found, (_quaternion(still), None))


def _quaternion(matrix: Array) -> _Four:
    found = np.empty(4)
    mujoco.mju_mat2Quat(found, matrix.reshape(9))
    w, x, y, z = found.tolist()
    return w, x, y, z


def _chain(compiled: CompiledRobot, body: int) -> _Chain:
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


def _turned(chain: _Chain, theta: Array, offset: Array) -> Array:
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
