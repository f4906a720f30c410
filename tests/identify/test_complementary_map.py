"""The K_C analysis of section 4.2 against check values of an independent computation, and against the full statics."""

import json
from pathlib import Path

import numpy as np
import pytest

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.complementary_map import (
    Grid,
    complementary_map,
    grid_over_limits,
    identify_by_position,
    loaded,
)
from bench.identify.complementary_prediction import prediction_error
from bench.robot.bodies import Point, read_only
from tests.identify.hh150 import DEGREE, STIFFNESS, hh150

CHECK = json.loads((Path(__file__).parents[2] / "models/hh150/paper/kc_analysis.json").read_text())
TABLE_3 = np.array([1.0, 1.5, 2.0, 0.5, 0.5, 0.5]) * 1e6  # [Nm/rad]
TABLE_4 = np.array([0.0, 0.0, 0.0, 0.0, 45.0, 0.0]) * DEGREE  # [rad], theta_2 and theta_3 sweep
SWEPT = (1, 2)
WORST = np.array([1500.0, 1500.0, 1500.0, 200.0, 200.0, 200.0])  # [N, Nm]
STEP = 2 * DEGREE  # the step of the check values: 76 x 123 poses

# Load and measuring point in the last frame [m], one and the same in the check values
POINTS = {"wrist": (0.0, 0.0, 0.0), "tool_z-0.45": (0.0, 0.0, -0.45), "tool_.1_0_-.45": (0.1, 0.0, -0.45)}

ONE_POSE = 1 / (76 * 123)  # a pose on the edge of a limit may fall to either side by rounding
ROUNDING = 1e-9  # relative; the same formulas in another order of operations
PRINTED = 0.05 + 1e-9  # [deg], loci were printed to 0.1 deg
SAMPLE = 400  # the check values of eps_P and eps_O are over so many poses of the zone, drawn with seed 0,
EVERY = 3  # each predicting every third grid point in either direction


@pytest.fixture(scope="module")
def arm():
    return Arm(hh150())


def point(name):
    return Point(5, read_only(POINTS[name]), read_only(np.eye(3)))


@pytest.fixture(scope="module")
def maps(arm):
    grid = grid_over_limits(arm, TABLE_4, SWEPT, STEP)
    return {name: complementary_map(arm, grid, point(name), TABLE_3, WORST) for name in POINTS}


@pytest.mark.parametrize("name", POINTS)
def test_fractions(maps, name):
    np.testing.assert_allclose(maps[name].fraction(0.05), CHECK[name]["frac5"], rtol=0, atol=ONE_POSE)
    np.testing.assert_allclose(maps[name].fraction(0.10), CHECK[name]["frac10"], rtol=0, atol=ONE_POSE)
    assert maps[name].zone().mean() == pytest.approx(CHECK[name]["all6_5"], rel=0, abs=ONE_POSE)


@pytest.mark.parametrize("name", POINTS)
def test_bands_follow_the_zeros_of_the_torque(maps, name):
    first = np.rad2deg(maps[name].grid.first)
    for joint in range(6):
        zeros = maps[name].zeros(joint)
        for theta_2, printed in CHECK[name][f"zero_locus_j{joint + 1}"]:
            found = np.rad2deg(zeros[int(np.argmin(np.abs(first - theta_2)))])
            expected = np.unique(printed)  # a zero on a grid point is printed twice
            assert len(found) == len(expected)
            np.testing.assert_allclose(found, expected, rtol=0, atol=PRINTED)


@pytest.mark.parametrize("name", POINTS)
def test_prediction_errors(arm, maps, name):
    inside = np.argwhere(maps[name].zone())
    chosen = inside[np.random.default_rng(0).choice(len(inside), SAMPLE, replace=False)]
    sample = np.zeros(maps[name].zone().shape, dtype=bool)
    sample[tuple(chosen.T)] = True
    error = prediction_error(arm, maps[name], point(name), sample, EVERY)
    assert np.nanmax(error.position) == pytest.approx(CHECK[name]["eps_P_max"], rel=ROUNDING)
    assert np.nanmedian(error.position) == pytest.approx(CHECK[name]["eps_P_med"], rel=ROUNDING)
    assert np.nanmax(error.orientation) == pytest.approx(CHECK[name]["eps_O_max"], rel=ROUNDING)


@pytest.mark.parametrize("name", POINTS)
def test_the_paper_s_bounds_hold_over_the_whole_zone(arm, maps, name):
    error = prediction_error(arm, maps[name], point(name), maps[name].zone())
    assert np.array_equal(np.isfinite(error.position), maps[name].zone())
    assert np.nanmax(error.position) < 0.07  # section 4.2
    assert np.nanmax(error.orientation) < 3e-4  # [rad]


def test_the_zone_hardly_depends_on_the_stiffness(arm, maps):
    """Section 4.2: with other values than Table 3 the zone "almost remains the same". Here with those of Table 6."""
    other = complementary_map(arm, maps["wrist"].grid, point("wrist"), STIFFNESS, WORST)
    assert np.mean(other.zone() == maps["wrist"].zone()) > 0.95


def test_deflection_is_that_of_the_full_statics_to_second_order(arm):
    """K Delta theta = J_f(theta + Delta theta)^T W, solved by iteration; Eq. (17) is its first-order solution."""
    q, where, errors = np.array([0.0, 20.0, -60.0, 0.0, 45.0, 0.0]) * DEGREE, point("tool_.1_0_-.45"), []
    for scale in (1.0, 0.5):
        exact = np.zeros(6)
        for _ in range(50):
            exact = arm.jacobian(q + exact, where).T @ (scale * WORST) / TABLE_3
        torque, with_kc = loaded(arm, q, where, TABLE_3, scale * WORST)
        errors.append(np.linalg.norm(with_kc - exact))
        assert errors[-1] < 0.05 * np.linalg.norm(torque / TABLE_3 - exact)  # without K_C it is that much worse
    assert errors[0] / errors[1] == pytest.approx(8, rel=0.05)  # what is left shrinks with the cube of the load


def test_six_rows_are_the_square_system_of_eq_39(arm, maps):
    """The quotient Gamma / Delta theta is the solution of Q N = J_m Delta theta with any measuring point."""
    result = maps["wrist"]
    for i, j in ((5, 20), (40, 100), (70, 30)):
        j_m = arm.jacobian(result.grid.angles[i, j], point("tool_.1_0_-.45"))
        compliance = np.linalg.solve(j_m * result.torque[i, j], j_m @ result.deflection[i, j])
        np.testing.assert_allclose(1 / compliance, result.identified[i, j], rtol=1e-8)  # condition of Q below 1e6


def test_error_vanishes_with_the_load(arm):
    grid = Grid(TABLE_4, SWEPT, np.array([0.3]), np.array([-0.9]))
    full, small = (complementary_map(arm, grid, point("wrist"), TABLE_3, s * WORST).relative_error for s in (1, 1e-3))
    np.testing.assert_allclose(small, 1e-3 * full, rtol=0.05)


class TestPositionRows:
    """The three position rows of Eq. (41), stacked over the six components of the worst load, one after the other."""

    def test_few_poses_are_bad(self, arm, maps):
        """With loads of several directions there is no band: where one load has no torque on a joint, another has."""
        name = "tool_.1_0_-.45"
        found = identify_by_position(
            arm, maps[name].grid.angles[::3, ::3], point(name), point(name), TABLE_3, np.diag(WORST)
        )
        good = np.all(np.abs(found / TABLE_3 - 1) < 0.05, axis=-1)
        assert good.mean() > 0.99 > maps[name].zone().mean()

    def test_joints_that_do_not_move_the_point_are_nan(self, arm):
        q = np.array([0.1, 20.0, -60.0, 30.0, 45.0, 10.0]) * DEGREE
        for name, unseen in (("wrist", [3, 4, 5]), ("tool_z-0.45", [5]), ("tool_.1_0_-.45", [])):
            found = identify_by_position(arm, q, point(name), point(name), TABLE_3, np.diag(WORST))
            assert np.flatnonzero(np.isnan(found)).tolist() == unseen

    def test_one_load_does_not_determine_six_joints(self, arm):
        q = np.array([0.1, 20.0, -60.0, 30.0, 45.0, 10.0]) * DEGREE
        where = point("tool_.1_0_-.45")
        assert np.isnan(identify_by_position(arm, q, where, where, TABLE_3, WORST[None])).all()


def test_input_is_checked(arm):
    grid = grid_over_limits(arm, TABLE_4, SWEPT, 50 * DEGREE)
    with pytest.raises(InputError, match="gives way"):  # or Figs. 4 to 6 were all NaN
        complementary_map(arm, grid, point("wrist"), TABLE_3, 1e17 * WORST)
    with pytest.raises(InputError, match="positive"):
        complementary_map(arm, grid, point("wrist"), -TABLE_3, WORST)
    with pytest.raises(InputError, match="wrench of 6"):
        complementary_map(arm, grid, point("wrist"), TABLE_3, WORST[:3])
