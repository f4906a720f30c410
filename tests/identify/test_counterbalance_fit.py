"""C and l_c: hidden values are found, with intervals that cover; the problem is what it says; laws are told apart."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.errors import InputError
from bench.identify.balancing_torque import BalancingTorque, Geometry
from bench.identify.counterbalance_check import predict, spread
from bench.identify.counterbalance_fit import CounterbalanceFit, fit_counterbalance
from bench.identify.gas_law_problem import GasLawProblem
from bench.identify.gas_law_profile import intervals, minimum
from bench.identify.traverse_friction import friction_over_speed
from bench.identify.traverses import traverses
from bench.record.campaign import Campaign
from bench.scenario.files import read_scenario
from bench.scenario.rotation import Rotation
from bench.simulate.session import Session
from tests.identify.rotation_world import Nominal, gas, run_with
from tests.simulate.rotation_small import small_rotation

SMALL_GAS = (1050.0, 0.71)  # [Nm], [m]; the folder says 900 and 0.65
HIDDEN_GAS = (4400.0, 0.93)  # [Nm], [m]; the folder says 4771.4 and 0.9112
SEEDS = 60
FULL_SEEDS = 200
GEOMETRY = Geometry(joint=1, rho=0.7, b=0.2, dead_centre=np.deg2rad(3.3))
NUISANCES = ("gain", "offset")
LIMITS = np.deg2rad([-40, 110])


@pytest.fixture(scope="module")
def session(small_robot: Path) -> Session:
    return run_with(small_rotation(small_robot), gas(*SMALL_GAS))


@pytest.fixture(scope="module")
def nominal(small_robot: Path) -> Nominal:
    return Nominal.of(str(small_robot))


def z_scores(fits: list[CounterbalanceFit], true: tuple[float, float]) -> np.ndarray:
    return np.array(
        [(np.array([f.gas_constant, f.critical_length]) - true) / np.sqrt(np.diag(f.covariance)) for f in fits]
    )


def coverage(fits: list[CounterbalanceFit], true: tuple[float, float]) -> np.ndarray:
    return np.mean([(f.intervals[:, 0] <= true) & (true <= f.intervals[:, 1]) for f in fits], axis=0)


def measured(low: float, high: float, sigma: float, rng: np.random.Generator | None = None) -> BalancingTorque:
    """M of the reference counterbalance, with a gain and an offset of which this noise is independent."""
    theta = np.deg2rad(np.arange(low, high, 0.5))
    torque = GEOMETRY.filled(4771.4, 0.9112).torque(theta)
    load = 2000 * np.sin(theta + 1)
    noise = 0 if rng is None else sigma * rng.standard_normal(len(theta))
    sensitivity = np.column_stack([0.02 * load, np.full_like(theta, 2.0)])
    return BalancingTorque("made", 0.1, 0.0, theta, torque + noise, np.full_like(theta, sigma), sensitivity)


def test_hidden_gas_is_found_with_honest_intervals(session: Session, nominal: Nominal) -> None:
    """z-scores have mean 0 and standard deviation 1, and 95 % intervals cover, within what so few seeds can tell."""
    fits = [nominal.fit_of_seed(session, seed) for seed in range(SEEDS)]
    z = z_scores(fits, SMALL_GAS)
    assert np.all(np.abs(z.mean(axis=0)) < 3 / np.sqrt(SEEDS))
    assert np.all(np.abs(z.std(axis=0) - 1) < 3 / np.sqrt(2 * SEEDS))
    assert np.all(coverage(fits, SMALL_GAS) >= 0.95 - 3 * np.sqrt(0.95 * 0.05 / SEEDS))
    assert np.median([fit.gas_constant for fit in fits]) == pytest.approx(SMALL_GAS[0], rel=0.01)


@pytest.mark.study
def test_intervals_cover_over_200_seeds() -> None:
    scenario = read_scenario("rotation")
    assert isinstance(scenario, Rotation)
    session, nominal = run_with(scenario, gas(*HIDDEN_GAS)), Nominal.of(scenario.robot)
    fits = [nominal.fit_of_seed(session, seed) for seed in range(FULL_SEEDS)]
    assert np.all((coverage(fits, HIDDEN_GAS) >= 0.92) & (coverage(fits, HIDDEN_GAS) <= 0.98))
    assert np.all(np.abs(z_scores(fits, HIDDEN_GAS).mean(axis=0)) < 3 / np.sqrt(FULL_SEEDS))


def test_friction_from_opposite_traverses(session: Session, nominal: Nominal) -> None:
    """Ideal instruments: 60 Nm on each side, no viscous friction; the twist of the link side is worth some 0.1 %."""
    ideal = Campaign(session.campaign.robot, session.ideal)
    found = friction_over_speed(traverses(ideal, nominal.drives, nominal.bodies.gravity))
    assert found.coulomb == pytest.approx(120, rel=0.01)
    assert found.viscous == pytest.approx(0, abs=2.0)


def test_m_is_the_cylinders(session: Session, nominal: Nominal) -> None:
    """With ideal instruments Eq. (32) gives M to some Nm of several hundred, at any speed and payload."""
    law = nominal.geometry.filled(*SMALL_GAS)
    torques = nominal.torques(Campaign(session.campaign.robot, session.ideal))
    assert len(torques) == 4
    for t in torques:
        np.testing.assert_allclose(t.torque, law.torque(t.theta), atol=0.01 * np.abs(t.torque).max())
    assert spread(torques).largest < 0.01
    assert spread(torques).zero == pytest.approx(nominal.geometry.dead_centre, abs=0.01)


def test_noise_stays_out_of_the_sensitivities(session: Session, nominal: Nominal) -> None:
    """A gain column with the data's own noise in it would let a gain shrink the noise and look like a better fit."""

    def roughness(theta: np.ndarray, values: np.ndarray) -> float:
        return float(np.std(values - np.polynomial.Polynomial.fit(theta, values, 9)(theta)))

    for t in nominal.torques(session.campaign):
        column = t.sensitivity[:, 0] / nominal.drives.torque_gain_sigma[0]
        assert roughness(t.theta, column) < 0.01 * roughness(t.theta, t.torque)


def test_chi_square_is_that_of_the_whole_covariance(rng: np.random.Generator) -> None:
    t = measured(-20, 40, 3.0, rng)
    problem = GasLawProblem.build([t], GEOMETRY)
    residual = t.torque - 4771.4 * problem.per_gas_constant(0.9112)
    covariance = np.diag(t.sigma**2) + t.sensitivity @ t.sensitivity.T
    direct = residual @ np.linalg.solve(covariance, residual)
    assert np.sum(problem.whitened(residual) ** 2) == pytest.approx(direct, rel=1e-9)
    expected = t.sensitivity.T @ np.linalg.solve(covariance, residual)
    np.testing.assert_allclose(problem.nuisances(residual), expected, rtol=1e-6)


def test_intervals_are_the_contour_of_chi_square(rng: np.random.Generator) -> None:
    """Against a plain grid over both unknowns, where the valley is long and bent."""
    problem = GasLawProblem.build([measured(-20, 40, 15.0, rng)], GEOMETRY)
    best, rise = minimum(problem), 3.84
    found = intervals(problem, best, rise)
    gaps = np.exp(np.linspace(np.log(0.1), np.log(3), 4000))
    rows = np.array([problem.for_critical_length(problem.length.max() + gap) for gap in gaps])
    inside = rows[:, 1] < best.chi_square + rise
    half = np.sqrt((best.chi_square + rise - rows[inside, 1]) / rows[inside, 2])
    np.testing.assert_allclose(found[0], [(rows[inside, 0] - half).min(), (rows[inside, 0] + half).max()], rtol=2e-3)
    np.testing.assert_allclose(found[1], problem.length.max() + gaps[inside][[0, -1]], rtol=2e-3)
    upper, lower = found[0, 1] - best.gas_constant, best.gas_constant - found[0, 0]
    assert upper > 1.05 * lower, "a wide interval is not symmetric"


def test_without_information_there_is_no_upper_end(rng: np.random.Generator) -> None:
    fit = fit_counterbalance([measured(-20, 40, 300.0, rng)], GEOMETRY, NUISANCES, LIMITS)
    assert np.all(np.isinf(fit.intervals[:, 1]))
    assert fit.preferred == "cannot tell"


def test_exact_data_give_exact_gas() -> None:
    fit = fit_counterbalance([measured(-20, 40, 1.0)], GEOMETRY, NUISANCES, LIMITS)
    assert fit.gas_constant == pytest.approx(4771.4, rel=1e-4)
    assert fit.critical_length == pytest.approx(0.9112, rel=1e-4)
    assert fit.correlation > 0.99
    assert any("correlated" in note for note in fit.notes)


def test_spring_or_gas_is_decided_by_a_wide_sweep_only(rng: np.random.Generator) -> None:
    narrow = fit_counterbalance([measured(-20, 40, 2.0, rng)], GEOMETRY, NUISANCES, LIMITS)
    wide = fit_counterbalance([measured(-35, 105, 2.0, rng)], GEOMETRY, NUISANCES, LIMITS)
    assert narrow.preferred == "cannot tell"
    assert any("cannot be decided" in note for note in narrow.notes)
    assert wide.preferred == "gas"
    assert np.sqrt(wide.covariance[0, 0]) < np.sqrt(narrow.covariance[0, 0]) / 3
    elsewhere = predict(narrow, [measured(-35, 105, 2.0, rng)])[0]
    assert elsewhere.error < 0.02
    assert elsewhere.spring_error > 0.2


def test_sigma_of_k_b_is_the_spread_of_k_b(rng: np.random.Generator) -> None:
    """First-order bands against k_b itself for draws of C and l_c."""
    fit = fit_counterbalance([measured(-20, 40, 2.0, rng)], GEOMETRY, NUISANCES, LIMITS)
    theta = np.deg2rad([-30.0, 20.0, 60.0])
    draws = rng.multivariate_normal([fit.gas_constant, fit.critical_length], fit.covariance, size=2000)
    laws = [GEOMETRY.filled(*draw) for draw in draws]
    np.testing.assert_allclose(
        fit.stiffness_sigma(theta), np.std([law.stiffness(theta) for law in laws], axis=0), rtol=0.1
    )
    np.testing.assert_allclose(fit.torque_sigma(theta), np.std([law.torque(theta) for law in laws], axis=0), rtol=0.1)


def test_a_pushing_cylinder_is_refused() -> None:
    t = measured(-20, 40, 1.0)
    with pytest.raises(InputError, match="pushes where it should pull"):
        fit_counterbalance([replace(t, torque=-t.torque)], GEOMETRY, NUISANCES, LIMITS)


def test_a_run_without_its_way_back_is_named(session: Session, nominal: Nominal) -> None:
    alone = replace(session.campaign, runs=session.campaign.runs[:3])
    with pytest.raises(InputError, match="payload5-speed25-up: has no run the other way"):
        traverses(alone, nominal.drives, nominal.bodies.gravity)


def test_ways_over_different_ranges_are_no_traverse(session: Session, nominal: Nominal) -> None:
    """The upper half of the way up and the lower half of the way down have no angle in common."""
    halves = [
        replace(run, columns={name: values[len(run) // 2 + 20 :] for name, values in run.columns.items()})
        for run in session.campaign.runs[:2]
    ]
    with pytest.raises(InputError, match="no run the other way"):
        traverses(replace(session.campaign, runs=tuple(halves)), nominal.drives, nominal.bodies.gravity)


def test_a_load_without_its_mass_is_named(session: Session, nominal: Nominal) -> None:
    runs = tuple(
        replace(run, columns={k: v for k, v in run.columns.items() if k != "load_mass_kg"})
        for run in session.campaign.runs
    )
    with pytest.raises(InputError, match="not the weight of load_mass_kg"):
        traverses(replace(session.campaign, runs=runs), nominal.drives, nominal.bodies.gravity)


def test_commands_are_not_needed(session: Session, nominal: Nominal) -> None:
    """Speed from the encoder instead: the same traverses, the same answer within the noise."""
    runs = tuple(
        replace(run, columns={k: v for k, v in run.columns.items() if not k.startswith("q_cmd")})
        for run in session.campaign.runs
    )
    with_commands, without = nominal.fit(session.campaign), nominal.fit(replace(session.campaign, runs=runs))
    sigma = np.sqrt(with_commands.covariance[0, 0])
    assert without.gas_constant == pytest.approx(with_commands.gas_constant, abs=0.5 * sigma)
