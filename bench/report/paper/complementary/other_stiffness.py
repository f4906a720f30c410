"""Whether the optimal zone (Fig. 6) stays where it is for other values of the stiffness, as the paper says it does."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.identify.arm import Arm
from bench.identify.complementary_map import ComplementaryMap, complementary_map
from bench.identify.complementary_prediction import prediction_error
from bench.report.paper.chapter import ChapterTable
from bench.report.paper.complementary.figures import GOOD
from bench.report.tables import Column, Measured, Row
from bench.robot.bodies import Array, Point

FACTORS = (0.5, 2.0)
EVERY = 4  # grid points along either axis at which deflections are predicted


@dataclass(frozen=True)
class OtherZone:
    """The map for another stiffness beside that of Table 3.

    Attributes:
        zone: Shape (a, b) bool.
        same: Share of the poses that are in both zones or in neither.
        kept: Share of the zone of Table 3 that is in this one.
        eps_p: Largest error of a predicted position, Eq. (45).
        eps_o: Largest error of a predicted orientation [rad], Eq. (46).
    """

    zone: NDArray[np.bool_]
    same: float
    kept: float
    eps_p: float
    eps_o: float


def stiffness_values(table3: Array, joint_names: Sequence[str]) -> dict[str, Array]:
    """Return what is tried, by name: all joints times each factor, and each joint alone; shape (n,) [Nm/rad] each."""
    tried = {f"all joints times {factor:g}": factor * table3 for factor in FACTORS}
    for j, name in enumerate(joint_names):
        for factor in FACTORS:
            tried[f"{name} times {factor:g}"] = np.where(np.arange(len(table3)) == j, factor, 1.0) * table3
    return tried


def other_zones(
    arm: Arm, table3: ComplementaryMap, tried: Mapping[str, Array], point: str | Point, wrench: Array
) -> dict[str, OtherZone]:
    """Return the zones for other values of the stiffness.

    Args:
        arm: The arm.
        table3: The map for the stiffness of Table 3.
        tried: Name -> shape (n,) [Nm/rad].
        point: Where the load acts and the deflection is predicted.
        wrench: Shape (6,) [N, Nm].
    """
    before = table3.zone(GOOD)
    found = {}
    for name, stiffness in tried.items():
        other = complementary_map(arm, table3.grid, point, stiffness, wrench)
        zone = other.zone(GOOD)
        error = prediction_error(arm, other, point, zone, EVERY)
        found[name] = OtherZone(
            zone,
            float(np.mean(zone == before)),
            float(np.mean(zone[before])),
            float(np.nanmax(error.position)),
            float(np.nanmax(error.orientation)),
        )
    return found


def zones_table(table3: NDArray[np.bool_], found: Mapping[str, OtherZone]) -> ChapterTable:
    """Return the zones as a table, that of Table 3 on top."""
    rows = [Row("Table 3", (*(Measured(100 * value) for value in (table3.mean(), 1.0, 1.0)), *_UNKNOWN))]
    rows += [
        Row(
            name,
            tuple(
                Measured(value)
                for value in (
                    100 * each.zone.mean(),
                    100 * each.same,
                    100 * each.kept,
                    100 * each.eps_p,
                    1e4 * each.eps_o,
                )
            ),
        )
        for name, each in found.items()
    ]
    columns = [
        Column("optimal zone", "% of the poses", 1),
        Column("as for Table 3", "% of the poses", 1),
        Column("of its zone kept", "%", 1),
        Column("largest eps_P", "%", 1),
        Column("largest eps_O", "1e-4 rad", 2),
    ]
    return ChapterTable("The optimal zone for other values of the stiffness", columns, rows)


_UNKNOWN = (Measured(np.nan), Measured(np.nan))


def zones_sentence(table3: NDArray[np.bool_], found: Mapping[str, OtherZone]) -> str:
    """Return whether the zone stays, as the paper says, in numbers."""
    least = min(found, key=lambda name: found[name].same)
    worst = max(found, key=lambda name: found[name].eps_o)
    common = np.all([table3, *(each.zone for each in found.values())], axis=0)
    factors = " and ".join(f"{factor:g}" for factor in FACTORS)
    return (
        f"The paper says that the zone hardly changes with the stiffness. For {len(found)} other stiffnesses (all "
        f"joints, and each alone, times {factors}) a pose is in the zone or out of it as for Table 3 in at least "
        f"{100 * found[least].same:.0f} % of the poses ({least}: {100 * found[least].zone.mean():.0f} % of the poses "
        f"are in the zone, {100 * table3.mean():.0f} % for Table 3); {100 * common.mean():.0f} % are in it for all. "
        "The bands "
        "about zero torque are where they were; they widen as the stiffness falls. The largest eps_O is "
        f"{1e4 * found[worst].eps_o:.1f}e-4 rad ({worst}; the paper's bound is 3e-4 rad)."
    )
