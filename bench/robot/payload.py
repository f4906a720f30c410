"""The arm with a payload, as plain numbers: a point mass added to the link that carries it."""

from dataclasses import replace

import numpy as np

from bench.errors import InputError, unknown_name
from bench.robot.bodies import Array, RigidBodies, read_only


def with_payload(bodies: RigidBodies, mass: float, point: str) -> RigidBodies:
    """Return the links with a point mass bolted to one of their points.

    Args:
        bodies: The arm without it.
        mass: [kg].
        point: Name of one of `bodies.points`.

    Raises:
        InputError: No such point, it is on the base, or the mass is negative.
    """
    if point not in bodies.points:
        raise InputError(unknown_name("point of the arm", point, bodies.points))
    place = bodies.points[point]
    if place.body < 0 or mass < 0:
        raise InputError(
            f"a payload of {mass:g} kg at {point!r}: needs a mass of 0 kg or more, and a point that moves."
        )
    if mass == 0:
        return bodies
    i = place.body
    total = bodies.mass[i] + mass
    com = (bodies.mass[i] * bodies.com[i] + mass * place.position) / total
    inertia = bodies.inertia[i] + _about(bodies.mass[i], bodies.com[i] - com) + _about(mass, place.position - com)
    return replace(
        bodies,
        mass=_with_row(bodies.mass, i, total),
        com=_with_row(bodies.com, i, com),
        inertia=_with_row(bodies.inertia, i, inertia),
    )


def _about(mass: float, offset: Array) -> Array:
    """Return the inertia of a point mass at `offset`, shape (3, 3) [kg m^2]."""
    return mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))


def _with_row(values: Array, row: int, value: Array | float) -> Array:
    changed = np.array(values)
    changed[row] = value
    return read_only(changed)
