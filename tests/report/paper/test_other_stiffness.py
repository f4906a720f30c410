"""The optimal zone for other values of the stiffness: what leaving K_C out costs goes with its reciprocal."""

import numpy as np
import pytest

from bench.identify.arm import Arm
from bench.identify.complementary_map import ComplementaryMap, complementary_map, grid_over_limits
from bench.report.paper.complementary.other_stiffness import (
    other_zones,
    stiffness_values,
    zones_sentence,
    zones_table,
)
from tests.identify.hh150 import hh150

TABLE_3 = np.array([1.0e6, 1.5e6, 2.0e6, 0.5e6, 0.5e6, 0.5e6])
WRENCH = np.array([1500.0] * 3 + [200.0] * 3)
JOINTS = tuple(f"joint{j}" for j in range(1, 7))
FIRST_ORDER = 0.1  # of the median error, which is itself below 1 %


@pytest.fixture(scope="module")
def arm() -> Arm:
    return Arm(hh150())


@pytest.fixture(scope="module")
def table3(arm: Arm) -> ComplementaryMap:
    grid = grid_over_limits(arm, np.deg2rad([0, 0, 0, 0, 45, 0]), (1, 2), np.deg2rad(6.0))
    return complementary_map(arm, grid, "load", TABLE_3, WRENCH)


def test_errors_go_with_the_reciprocal_of_the_stiffness(arm: Arm, table3: ComplementaryMap) -> None:
    """Delta theta = (K - K_C)^-1 Gamma, so to first order the relative error of k is that of K^-1 K_C."""
    softer = complementary_map(arm, table3.grid, "load", TABLE_3 / 2, WRENCH)
    ratio = np.nanmedian(softer.relative_error, axis=(0, 1)) / np.nanmedian(table3.relative_error, axis=(0, 1))
    np.testing.assert_allclose(ratio, 2, rtol=FIRST_ORDER)


def test_a_stiffer_arm_keeps_the_zone_and_a_softer_one_loses_some_of_it(arm: Arm, table3: ComplementaryMap) -> None:
    tried = stiffness_values(TABLE_3, JOINTS)
    assert len(tried) == 14
    np.testing.assert_array_equal(tried["joint2 times 0.5"], TABLE_3 * [1, 0.5, 1, 1, 1, 1])
    found = other_zones(arm, table3, tried, "load", WRENCH)
    zone = table3.zone()
    assert found["all joints times 2"].kept > 0.99
    assert found["all joints times 0.5"].zone.mean() < zone.mean() < found["all joints times 2"].zone.mean()
    table = zones_table(zone, found)
    assert [row.name for row in table.rows] == ["Table 3", *tried]
    assert "(all joints times 0.5:" in zones_sentence(zone, found)


def test_the_same_stiffness_gives_the_same_zone(arm: Arm, table3: ComplementaryMap) -> None:
    (same,) = other_zones(arm, table3, {"Table 3": TABLE_3}, "load", WRENCH).values()
    assert same.same == same.kept == 1.0
