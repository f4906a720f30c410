"""An arm from a table of modified Denavit-Hartenberg parameters, Eq. (2), for robots known by their table alone."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from bench.robot.bodies import Array, Point, RigidBodies, read_only


@dataclass(frozen=True)
class Row:
    """One line of a modified Denavit-Hartenberg table, Table 1.

    Attributes:
        a: a_{i-1} [m].
        alpha: alpha_{i-1} [rad].
        d: d_i [m].
        zero: Angle theta_i of the table where the joint reads zero [rad] (the bracket in Table 1).
        limits: Lowest and highest joint angle [rad].
        mass: Mass of the link [kg].
        com: Centre of mass in frame i [m].
        inertia: About the centre of mass, in axes of frame i [kg m^2].
    """

    a: float
    alpha: float
    d: float
    zero: float
    limits: tuple[float, float]
    mass: float = 0.0
    com: tuple[float, float, float] = (0.0, 0.0, 0.0)
    inertia: tuple[float, float, float] = (0.0, 0.0, 0.0)


def bodies_from_table(rows: Sequence[Row], points: Mapping[str, Sequence[float]], gravity: float = 9.81) -> RigidBodies:
    """Return the links of a serial arm; body i carries frame i of the table.

    Args:
        rows: The table, base first. World axes are those of frame 0, z up.
        points: Name -> position in the last frame [m].
        gravity: [m/s^2], along -z.
    """
    n = len(rows)
    rotation = [_turn_x(row.alpha) @ _turn_z(row.zero) for row in rows]
    position = [_turn_x(row.alpha) @ np.array([0.0, 0.0, row.d]) + np.array([row.a, 0.0, 0.0]) for row in rows]
    return RigidBodies(
        names=tuple(f"joint_{i + 1}" for i in range(n)),
        parent=np.arange(n) - 1,
        is_hinge=np.ones(n, dtype=np.bool_),
        position=read_only(position),
        rotation=read_only(rotation),
        axis=read_only([[0.0, 0.0, 1.0]] * n),
        mass=read_only([row.mass for row in rows]),
        com=read_only([row.com for row in rows]),
        inertia=read_only([np.diag(row.inertia) for row in rows]),
        limits=read_only([row.limits for row in rows]),
        gravity=read_only([0.0, 0.0, -gravity]),
        points={name: Point(n - 1, read_only(where), read_only(np.eye(3))) for name, where in points.items()},
    )


def _turn_x(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def _turn_z(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
