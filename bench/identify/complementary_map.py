"""Where the complementary stiffness K_C may be left out of the identification: section 4.2, Figs. 4 to 6.

The robot is loaded on paper: K_C acts, so by Eq. (17) the joints deflect by Delta theta = (K_theta - K_C)^-1 Gamma with
Gamma = J_f^T W. The stiffness is then identified from that deflection by the simplified equations, which have no K_C.

With all six rows, Q N = Delta X of Eq. (39) is square. Q = J_m diag(Gamma) and Delta X = J_m Delta theta, so
N_j = Delta theta_j / Gamma_j: the measuring point and the conditioning of J_m drop out, and the error depends on the
load alone. It is large where Gamma_j passes through zero, in narrow bands. The three position rows of Eq. (41) cannot
be solved for six joints at one pose and load; they need several loads (`identify_by_position`).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.errors import InputError
from bench.identify.arm import Arm, complementary_stiffness
from bench.robot.bodies import Array, Point, read_only

SAME_RANK = 1e-9  # of the largest singular value of the column-scaled rows; far above rounding


@dataclass(frozen=True)
class Grid:
    """Poses in which two joints sweep while the others rest, Table 4.

    Attributes:
        rest: Shape (n,) [rad], angles of the joints that rest; the entries of the swept joints do not matter.
        joints: Indices of the two swept joints, from 0.
        first: Shape (a,) [rad], angles of the first swept joint, ascending.
        second: Shape (b,) [rad], angles of the second swept joint, ascending.
    """

    rest: Array
    joints: tuple[int, int]
    first: Array
    second: Array

    @property
    def angles(self) -> Array:
        """Shape (a, b, n) [rad]."""
        q = np.tile(self.rest, (len(self.first), len(self.second), 1))
        q[..., self.joints[0]] = self.first[:, None]
        q[..., self.joints[1]] = self.second
        return q


@dataclass(frozen=True)
class ComplementaryMap:
    """What leaving K_C out does to the identified stiffness, pose by pose.

    Attributes:
        grid: The poses.
        stiffness: Shape (n,) [Nm/rad], the true one, Table 3.
        torque: Shape (a, b, n) [Nm], Gamma = J_f^T W, Eq. (13).
        deflection: Shape (a, b, n) [rad], Delta theta with K_C, Eq. (17).
    """

    grid: Grid
    stiffness: Array
    torque: Array
    deflection: Array

    @property
    def identified(self) -> Array:
        """Shape (a, b, n) [Nm/rad]; k by the six rows of Eq. (39); 0 where Gamma_j = 0, inf where the joint stays."""
        rigid = np.full_like(self.torque, np.inf)
        return np.divide(self.torque, self.deflection, out=rigid, where=self.deflection != 0)

    @property
    def relative_error(self) -> Array:
        """Shape (a, b, n); |k / k_true - 1|, Fig. 4."""
        return np.abs(self.identified / self.stiffness - 1)

    def fraction(self, limit: float) -> Array:
        """Return the share of the poses in which the relative error is below `limit`, shape (n,)."""
        share: Array = np.mean(self.relative_error < limit, axis=(0, 1))
        return share

    def zone(self, limit: float = 0.05) -> NDArray[np.bool_]:
        """Return the optimal zone, Fig. 6, shape (a, b): the relative error of every joint is below `limit`."""
        inside: NDArray[np.bool_] = np.all(self.relative_error < limit, axis=-1)
        return inside

    def zeros(self, joint: int) -> tuple[Array, ...]:
        """Return where Gamma_j = 0: for each angle of the first joint, those of the second, ascending [rad].

        Linear interpolation between grid points; with a step of 2 deg this is right to 0.03 deg.
        """
        return tuple(_crossings(self.grid.second, row) for row in self.torque[..., joint])


def grid_over_limits(arm: Arm, rest: Array, joints: tuple[int, int], step: float) -> Grid:
    """Return a grid over the full range of two joints, both ends included.

    Args:
        arm: The arm.
        rest: Shape (n,) [rad], angles of the other joints.
        joints: Indices of the swept joints, from 0.
        step: [rad]; rounded so that the range is a whole number of steps.
    """
    first, second = (
        np.linspace(low, high, round((high - low) / step) + 1) for low, high in arm.bodies.limits[list(joints)]
    )
    return Grid(read_only(rest), joints, read_only(first), read_only(second))


def loaded(arm: Arm, q: Array, load_point: str | Point, stiffness: Array, wrench: Array) -> tuple[Array, Array]:
    """Return the torque of the load and the deflection of the joints with K_C, Eqs. (13) and (17).

    Args:
        arm: The arm.
        q: Shape (..., n) [rad].
        load_point: Where the wrench acts.
        stiffness: Shape (n,) [Nm/rad].
        wrench: Shape (6,) [N, Nm], force and moment in base axes.

    Returns:
        Gamma, shape (..., n) [Nm], and Delta theta, shape (..., n) [rad].

    Raises:
        InputError: The arm gives way under the load somewhere: K_theta - K_C is not positive there.
    """
    jacobian = arm.jacobian(q, load_point)
    torque = np.einsum("...kn,k->...n", jacobian, wrench)
    yielding = np.diag(stiffness) - complementary_stiffness(jacobian, wrench)
    if not np.all(np.linalg.eigvalsh(yielding + np.swapaxes(yielding, -1, -2)) > 0):
        raise InputError(
            "K_C map: the arm gives way under this load, for a joint is softer than the load's own stiffness K_C "
            "somewhere; correct the load (N, Nm) or the stiffness (Nm/rad)."
        )
    return torque, np.linalg.solve(yielding, torque[..., None])[..., 0]


def complementary_map(
    arm: Arm, grid: Grid, load_point: str | Point, stiffness: Array, wrench: Array
) -> ComplementaryMap:
    """Return the map over a grid; arguments as for `loaded`.

    Raises:
        InputError: A stiffness is not positive, or a shape does not fit the arm.
    """
    n = arm.n_joints
    if stiffness.shape != (n,) or grid.rest.shape != (n,) or wrench.shape != (6,):
        raise InputError(f"K_C map: needs {n} stiffnesses, {n} joint angles and a wrench of 6 components.")
    if not np.all(stiffness > 0):
        raise InputError("K_C map: every stiffness must be positive.")
    return ComplementaryMap(
        grid, read_only(stiffness), *map(read_only, loaded(arm, grid.angles, load_point, stiffness, wrench))
    )


def identify_by_position(
    arm: Arm, q: Array, load_point: str | Point, reference_point: str | Point, stiffness: Array, wrenches: Array
) -> Array:
    """Return k by the position rows of Eq. (41), those of several loads at one pose stacked, shape (..., n) [Nm/rad].

    nan where these rows do not determine a joint, such as one whose axis runs through the reference point.

    Args:
        arm: The arm.
        q: Shape (..., n) [rad].
        load_point: Where the wrenches act.
        reference_point: Point whose position is measured.
        stiffness: Shape (n,) [Nm/rad], the true one.
        wrenches: Shape (c, 6) [N, Nm], one after the other.
    """
    cases = [loaded(arm, q, load_point, stiffness, wrench) for wrench in wrenches]
    torque, deflection = (np.stack(parts, axis=-2) for parts in zip(*cases, strict=True))
    position = arm.jacobian(q, reference_point)[..., None, :3, :]
    rows = (position * torque[..., None, :]).reshape(*q.shape[:-1], -1, q.shape[-1])  # L, Eq. (42)
    moved = (position @ deflection[..., None]).reshape(*q.shape[:-1], -1)
    size = np.linalg.norm(rows, axis=-2)
    size = np.where(size > SAME_RANK * size.max(axis=-1, keepdims=True), size, np.inf)
    left, values, right = np.linalg.svd(rows / size[..., None, :], full_matrices=False)
    seen = values > SAME_RANK * values[..., :1]
    inverse = np.divide(1.0, values, out=np.zeros_like(values), where=seen)
    compliance: Array = np.einsum("...in,...i,...ki,...k->...n", right, inverse, left, moved, optimize=True) / size
    known = np.einsum("...in,...i->...n", right**2, seen) > 1 - SAME_RANK
    identified: Array = np.full_like(compliance, np.nan)
    np.divide(1.0, compliance, out=identified, where=known & (compliance != 0))
    return identified


def _crossings(at: Array, values: Array) -> Array:
    """Return where piecewise linear values pass through zero, ascending."""
    nodes = at[values == 0]
    before = np.flatnonzero(values[:-1] * values[1:] < 0)
    share = values[before] / (values[before] - values[before + 1])
    return np.sort(np.concatenate([nodes, at[before] + share * (at[before + 1] - at[before])]))
