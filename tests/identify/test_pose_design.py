"""Planned information against dense algebra, predictions against Monte Carlo, designed poses against the paper's."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.denavit_hartenberg import bodies_from_table
from bench.identify.methods import METHODS
from bench.identify.options import Options
from bench.identify.pose_candidates import Rules, allowed, sample
from bench.identify.pose_design import design_poses
from bench.identify.pose_plan import PLANNED, Load, Setup, Visits, information, planned_readings
from bench.identify.pose_precision import expected_precision
from bench.identify.readings import Systematic
from tests.identify.hh150 import COUNTERBALANCE, DEGREE, STIFFNESS, TABLE_1, TORQUE_CONSTANT

PAPER = Path(__file__).parents[2] / "models/hh150/paper"
A1 = json.loads((PAPER / "configurations.json").read_text())["A1"]
DOWN = (0.0, 0.0, -1.0)
FORCES = (467.0, 641.0, 815.0, 990.0)  # [N], Table 5, configurations 2 and 3 rounded
SLANTING_FORCE = 1190.0  # [N], Table 5, configurations 5 and 6
RULES = Rules(worst_wrench=np.array([1500.0] * 3 + [200.0] * 3))
SEEDS = 200


@pytest.fixture(scope="module")
def setup():
    points = {"load": A1["p_f_frame6_m"], "reference": A1["p_m_frame6_m"]}
    return Setup(
        arm=Arm(bodies_from_table(TABLE_1, points)),
        counterbalance=COUNTERBALANCE,
        compliance=1 / STIFFNESS,
        load_point="load",
        reference_point="reference",
        sigma_reflector=30e-6,
        sigma_current_torque=0.02 * TORQUE_CONSTANT,
        sigma_wrench=np.array([0.5] * 3 + [0.2] * 3),
        systematic=Systematic(np.full(6, 0.02)),
    )


@pytest.fixture(scope="module")
def paper():
    """Return the six configurations with the loads of Table 5; 1 to 4 list magnitudes of hanging loads."""
    with (PAPER / "table5.csv").open() as file:
        rows = list(csv.DictReader(file))
    loads = []
    for number in range(1, 7):
        states = [row for row in rows if int(row["configuration"]) == number]
        forces = np.array([[float(state[f"f{axis}_N"]) for axis in "xyz"] for state in states])
        size = np.linalg.norm(forces[1:], axis=1)
        loads.append(Load(DOWN if number <= 4 else tuple(forces[1] / size[0]), tuple(size)))
    return Visits(np.array(A1["q_deg"]) * DEGREE, tuple(loads))


@pytest.fixture(scope="module")
def designed(setup):
    """Six poses with as many states as the paper's: four hanging loads at each, or one that slants by 45 deg."""
    side = np.sqrt(0.5)
    slanting = [Load((side * np.cos(a), side * np.sin(a), -side), (SLANTING_FORCE,)) for a in np.arange(8) * np.pi / 4]
    return design_poses(setup, "current", RULES, Load(DOWN, FORCES), slanting, 6, 2, np.random.default_rng(1))


@pytest.mark.parametrize("method", PLANNED)
def test_information_is_that_of_all_rows_with_free_offsets(setup, paper, method):
    """Each visit alone, as one dense least-squares problem whose offset is three more unknowns."""
    planned = information(setup, paper, PLANNED[method])
    readings = planned_readings(setup, paper)
    problem = PLANNED[method].build(setup, readings)
    p = problem.regressor.shape[2]
    for visit in range(len(paper.loads)):
        states = np.flatnonzero(readings.series == visit)
        rows = np.concatenate([problem.regressor[states], np.tile(np.eye(3), (len(states), 1, 1))], axis=2)
        total = np.einsum("mki,mkl,mlj->ij", rows, np.linalg.inv(problem.covariance[states]), rows)
        offset = total[p:, p:]
        expected = total[:p, :p] - total[:p, p:] @ np.linalg.inv(offset) @ total[p:, :p]
        scale = np.concatenate([setup.compliance, np.ones(p - 6)])
        expected = expected * np.outer(scale, scale)
        np.testing.assert_allclose(planned[visit], expected, rtol=1e-6, atol=1e-9 * np.abs(expected).max())


def test_planned_readings_are_what_the_methods_expect(setup, paper):
    """Without noise every method returns the stiffness that the readings were planned with."""
    readings = planned_readings(setup, paper)
    for method in PLANNED:
        found = METHODS[method](setup.arm, setup.counterbalance, readings, Options())
        np.testing.assert_allclose(found.compliance, setup.compliance, rtol=1e-5)


def noisy(setup, readings, rng):
    """Return readings with the noise of the instruments, and one direction error of the force sensor."""
    root = np.sqrt(setup.n_repeats)
    tilt = setup.systematic.force_direction * rng.standard_normal(3)
    turned = readings.wrench.copy()
    turned[~readings.is_vertical, :3] += np.cross(tilt, turned[~readings.is_vertical, :3])
    return replace(
        readings,
        current_torque=readings.current_torque
        + setup.sigma_current_torque / root * rng.standard_normal(readings.current_torque.shape),
        reflectors=readings.reflectors + setup.sigma_reflector / root * rng.standard_normal(readings.reflectors.shape),
        wrench=turned + setup.sigma_wrench / root * rng.standard_normal(readings.wrench.shape),
    )


@pytest.mark.parametrize("method", PLANNED)
@pytest.mark.parametrize("poses", ["paper", "designed"])
def test_prediction_is_confirmed_by_monte_carlo(setup, method, poses, request):
    """The methods themselves, on noisy readings: squared errors weighed by the predicted covariance are chi-square."""
    visits = request.getfixturevalue(poses)
    visits = visits if poses == "paper" else visits.visits
    predicted = expected_precision(setup, visits, method)
    readings, rng = planned_readings(setup, visits), np.random.default_rng(7)
    found = [
        METHODS[method](setup.arm, setup.counterbalance, noisy(setup, readings, rng), Options()).compliance
        for _ in range(SEEDS)
    ]
    error = np.array(found) / setup.compliance - 1
    # the sum of squares over SEEDS draws is chi-square; the band holds 99.9 % of what chance does, for each joint
    low, high = stats.chi2.ppf([0.0005, 0.9995], SEEDS) / SEEDS
    z = error / (predicted.standard_error / STIFFNESS)
    assert np.all((np.mean(z**2, axis=0) > low) & (np.mean(z**2, axis=0) < high))
    together = np.einsum("si,ij,sj->s", error, np.linalg.inv(predicted.covariance), error)
    assert stats.kstest(together, stats.chi2(6).cdf).pvalue > 0.001


def test_designed_poses_say_more_than_the_paper_s(setup, paper, designed):
    """Same number of poses and of states: every joint better, with less than half the repeats for the same."""
    theirs = expected_precision(setup, paper, "current")
    assert designed.precision.efficiency(theirs) > 2.5
    assert np.all(designed.precision.standard_error < theirs.standard_error)
    assert designed.precision.condition_number < theirs.condition_number
    assert theirs.efficiency(theirs) == pytest.approx(1)


def test_wrong_guess_of_the_stiffness_costs_little(setup, designed):
    guess = STIFFNESS * np.array([2.0, 0.5, 2.0, 0.5, 2.0, 0.5])
    loads = [load for load in designed.visits.loads if load.direction != DOWN]
    rng = np.random.default_rng(1)
    wrong = design_poses(replace(setup, compliance=1 / guess), "current", RULES, Load(DOWN, FORCES), loads, 6, 2, rng)
    true = expected_precision(setup, wrong.visits, "current")
    assert true.efficiency(designed.precision) > 0.9


def test_design_keeps_the_rules(setup, designed):
    assert np.all(allowed(setup, designed.visits, RULES))
    assert sum(load.direction != DOWN for load in designed.visits.loads) == 2
    np.testing.assert_allclose(designed.q_deg, np.round(designed.q_deg), atol=1e-9)


def test_design_is_deterministic(setup):
    def q(seed):
        rng = np.random.default_rng(seed)
        return design_poses(setup, "current", RULES, Load(DOWN, FORCES), [], 2, 0, rng).q_deg

    assert np.array_equal(q(3), q(3))
    assert not np.array_equal(q(3), q(4))


def test_hanging_loads_alone_do_not_show_the_vertical_axis(setup, paper):
    """Section 3: a vertical load puts no torque on joint 1."""
    hanging = expected_precision(setup, paper.take([0, 1, 2, 3]), "current")
    assert hanging.observable.tolist() == [False, True, True, True, True, True]
    assert np.isnan(hanging.standard_error[0])
    assert "joint_1 will not be observable" in hanging.notes[0]
    everything = expected_precision(setup, paper, "current")
    assert hanging.efficiency(everything) == 0
    assert everything.efficiency(hanging) == np.inf


def test_next_pose_makes_up_for_what_is_missing(setup, paper):
    """After four hanging loads the next visit is a slanting one, and all joints are observable."""
    slanting = [Load((0.0, 0.8, -0.6), (SLANTING_FORCE,))]
    before = paper.take([0, 1, 2, 3])
    rng = np.random.default_rng(2)
    design = design_poses(setup, "current", RULES, Load(DOWN, FORCES), slanting, 1, 1, rng, before)
    assert design.visits.loads == (slanting[0],)
    assert design.precision.observable.all()


def test_gain_errors_are_added_apart(setup, paper):
    """No pose reveals the gain of the torque constant: 2 % of k at every joint, on top of the noise."""
    precision = expected_precision(setup, paper, "current")
    expected = np.hypot(precision.standard_error, 0.02 * STIFFNESS)
    np.testing.assert_allclose(precision.total_standard_error, expected, rtol=1e-9)


class TestRules:
    """One pose that keeps the rules, and changes that break them one at a time."""

    Q = np.array([0.0, 30.0, -55.0, 10.0, 5.0, 20.0])  # [deg], the tool points upwards a little
    HANGING = Load(DOWN, FORCES)
    SLANTING = Load((0.0, 0.8, -0.6), (SLANTING_FORCE,))

    def keeps(self, setup, q, load=HANGING, **changes):
        return bool(allowed(setup, Visits(q[None] * DEGREE, (load,)), replace(RULES, **changes))[0])

    def test_pose_is_allowed(self, setup):
        assert self.keeps(setup, self.Q)

    @pytest.mark.parametrize(
        "change",
        [
            {"zone_limit": 1e-4},
            {"margin": 81 * DEGREE},  # joint 2 stands 80 deg from its limit
            {"floor": 2.0},
            {"clearance": 2.5},
            {"hanging_height": 2.5},
            {"rope_clearance": 0.5},
        ],
        ids=lambda change: next(iter(change)),
    )
    def test_each_rule_refuses(self, setup, change):
        assert not self.keeps(setup, self.Q, **change)

    def test_rules_of_hanging_loads_leave_slanting_ones_alone(self, setup):
        assert self.keeps(setup, self.Q, self.SLANTING, hanging_height=2.5, rope_clearance=0.5)

    def test_joints_above_the_load_point_are_not_in_the_rope_s_way(self, setup):
        """With the tool straight down only the base lies below the load point, and that is far away."""
        down = np.array([0.0, 30.0, -55.0, 10.0, 105.0, 20.0])
        assert self.keeps(setup, down, rope_clearance=0.5)

    def test_impossible_rules_are_said(self, setup):
        with pytest.raises(InputError, match="relax them"):
            sample(setup, [self.HANGING], replace(RULES, floor=10.0), 10, np.random.default_rng(0))


def test_a_load_point_on_the_last_axis_is_said(setup):
    """It said "allow slanting loads or more poses", of which none helps."""
    points = {"load": [0.0, 0.0, A1["p_f_frame6_m"][2]], "reference": A1["p_m_frame6_m"]}
    on_axis = replace(setup, arm=Arm(bodies_from_table(TABLE_1, points)))
    side = np.sqrt(0.5)
    visits = sample(
        on_axis, [Load(DOWN, FORCES), Load((side, 0.0, -side), FORCES)], RULES, 20, np.random.default_rng(3)
    )
    (note,) = expected_precision(on_axis, visits, "current").notes
    assert note.startswith("joint_6 will not be observable. The load point lies on the axis of joint_6, so in no pose")
    assert "slanting" not in note
    hanging = sample(setup, [Load(DOWN, FORCES)], RULES, 20, np.random.default_rng(3))
    (note,) = expected_precision(setup, hanging, "current").notes
    assert note == (
        "joint_1 will not be observable: the loads put too little torque on it; allow slanting loads or more poses."
    )
