"""Eq. (25) as the paper states it: the sums of Eq. (24), plain least squares, and what noise in its regressor does."""

import numpy as np
import pytest

from bench.identify.arm import Arm, complementary_stiffness
from bench.identify.force_paper import AS_IF_EXACT, identify_force_paper
from bench.identify.force_pose import identify_force_pose
from bench.identify.options import Options
from bench.identify.readings import StaticReadings
from bench.identify.rigid_motion import pose_deflection
from tests.identify.hh150 import COUNTERBALANCE, STIFFNESS, hh150
from tests.identify.test_force_pose import world_readings

ROUNDING = 1e-6  # of normal equations against orthogonal ones


@pytest.fixture(scope="module")
def arm() -> Arm:
    return Arm(hh150())


def literal(arm: Arm, readings: StaticReadings) -> np.ndarray:
    """Return K of Eqs. (20), (23) and (24), state by state and sum by sum."""
    load, change = readings.load(arm.bodies.gravity), pose_deflection(readings).change
    rows, right = [], []
    for i in np.flatnonzero(~readings.is_reference):
        first = readings.first_of_series[i]
        before, q = readings.q_motor[first], readings.q_motor[i]
        half_way = (before + q)[None] / 2  # of what the motor gives, which Eq. (1) has not
        moving = arm.jacobian(half_way, readings.reflector_names[0])[0]
        loading = arm.jacobian(half_way, readings.load_point)[0]
        if np.linalg.cond(moving) > 1e4:
            continue
        j_m, j_f = np.linalg.inv(moving), np.linalg.inv(arm.jacobian(before[None], readings.load_point)[0].T)
        by_load = change[i] - moving @ (q - before)
        bent = [sum(j_m[k, m] * by_load[m] for m in range(6)) for k in range(6)]
        rows.append([[j_f[r, k] * bent[k] for k in range(6)] for r in range(6)])
        right.append(load[i] + j_f @ complementary_stiffness(loading[None], load[i][None])[0] @ bent)
    return np.linalg.lstsq(np.concatenate(rows), np.concatenate(right), rcond=None)[0]


def test_it_is_eq_25_written_out(arm: Arm) -> None:
    readings = world_readings(np.random.default_rng(1), noisy=False)
    found = identify_force_paper(arm, COUNTERBALANCE, readings, Options())
    np.testing.assert_allclose(found.stiffness, literal(arm, readings), rtol=ROUNDING)


def test_noise_of_the_orientation_makes_joints_soft_and_the_interval_does_not_know(arm: Arm) -> None:
    readings = world_readings(np.random.default_rng(2), noisy=True)
    plain = identify_force_paper(arm, COUNTERBALANCE, readings, Options())
    weighted = identify_force_pose(arm, COUNTERBALANCE, readings, Options())
    assert np.nanmedian(plain.stiffness / STIFFNESS) < 0.9
    assert np.nanmedian(np.abs(weighted.stiffness / STIFFNESS - 1)) < 0.02
    low, high = plain.interval(0.95).T
    assert np.mean((low <= STIFFNESS) & (high >= STIFFNESS)) < 0.5
    assert AS_IF_EXACT in plain.notes
