"""In which unit, and on which side of the gear, a family of angles seems to be."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.record.campaign import Array
from bench.record.look.families import Family
from bench.record.rules.scale import BESIDE, FAR, MAX_ANGLE
from bench.record.turns import whole_turns
from bench.record.units import FOREIGN
from bench.robot.nominal_dynamics import NominalDynamics

# joint: as it is read. either: in range as degrees, or one of the motor. motor: out of range in any unit
Side = Literal["joint", "either", "motor"]
HALF = 0.5  # of the joints (assumed)
SLOWEST_GEAR = 6.0  # assumed: ratio of the quasi-direct drives of legged robots; others are geared down by 30 and more
DEGREE = FOREIGN["deg"].factor


@dataclass(frozen=True)
class AngleUnit:
    """How a family of angles reads, all of its hinges alike.

    Attributes:
        factor: To radians, if the side is that of the joint; of an unknown unit 1.
        unit: "rad" or what its name says; "" if it has none and is out of range in radians and in degrees.
        side: Of the gear.
        why: What the guess was made from.
    """

    factor: float
    unit: str
    side: Side
    why: str


def reaches(nominal: NominalDynamics | None, n: int) -> Array:
    """Return how far each joint goes to either side, shape (n,) [rad] or [m]; what any arm does if it is not known."""
    if nominal is None:
        return np.full(n, MAX_ANGLE / FAR)
    limits = nominal.bodies.limits
    return np.where(limits[:, 1] > limits[:, 0], np.max(np.abs(limits), axis=1), MAX_ANGLE / FAR)


def angle_unit(family: Family, columns: Mapping[str, Array], reach: Array, is_known: bool) -> AngleUnit:
    """Return how the hinges of a family read.

    Args:
        family: Hinges alone.
        columns: Of the log.
        reach: How far each of its joints goes to either side, shape (n,) [rad].
        is_known: Whether that is the robot's own range.
    """
    largest = np.array([np.max(np.abs(columns[source])) for source in family.sources])
    foreign = FOREIGN.get(family.unit)
    if family.unit == "rad" or (foreign and foreign.si == "rad"):
        factor = foreign.factor if foreign else 1.0
        side: Side = "motor" if _is_of_motors(factor * largest, reach) else "joint"
        return AngleUnit(factor, family.unit, side, f"unit {family.unit} in its name")
    if np.all(largest <= FAR * reach):
        return AngleUnit(1.0, "rad", "joint", "taken as rad")
    reached = f"reaches {np.max(largest):.3g}"
    if _is_of_motors(DEGREE * largest, reach):
        return AngleUnit(1.0, "", "motor", f"{reached}, out of range in rad and in degrees")
    if is_known:
        return AngleUnit(DEGREE, "deg", "either", reached)
    return AngleUnit(DEGREE, "deg", "joint", f"{reached}, so degrees")


def turns_of(family: Family, columns: Mapping[str, Array], nominal: NominalDynamics) -> dict[int, int]:
    """Return by how many whole turns each hinge of a family is on, in the unit of its name or in radians.

    That is the likely cause where fewer than half of the hinges are out of range, each one of them with a turn to go or
    more, and come into it. Empty where none is on, or where that does not explain all.

    Args:
        family: Hinges alone.
        columns: Of the log.
        nominal: The robot.
    """
    foreign = FOREIGN.get(family.unit)
    factor = foreign.factor if foreign and foreign.si == "rad" else 1.0
    reach, found = reaches(nominal, nominal.n_joints), {}
    for number, source in zip(family.numbers, family.sources, strict=True):
        angle = factor * columns[source]
        lower, upper = nominal.bodies.limits[number - 1]
        if lower >= upper:  # it has none
            lower, upper = -MAX_ANGLE, MAX_ANGLE
        beside, most = BESIDE["rad"], float(np.max(np.abs(angle)))
        is_out = np.min(angle) < lower - beside or np.max(angle) > upper + beside
        found[number] = whole_turns(angle, float(lower), float(upper), beside) if is_out else 0
        if not found[number] and most > FAR * reach[number - 1]:
            return {}
    used = sum(bool(np.any(columns[source])) for source in family.sources)
    return found if 0 < sum(map(bool, found.values())) < HALF * used else {}


def _is_of_motors(largest: Array, reach: Array) -> bool:
    """Return whether angles [rad] are too far for joints: one of them by a gear, or half of those that are not at zero.

    A single joint that goes a little further than its model says is no reason to doubt the others.
    """
    used = largest > 0
    return bool(
        np.any(largest > SLOWEST_GEAR * reach) or (np.any(used) and np.mean((largest > FAR * reach)[used]) >= HALF)
    )
