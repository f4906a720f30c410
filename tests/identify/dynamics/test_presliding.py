"""Friction that turns over some travel after a joint turns round: its column, and that it is no inertia."""

from dataclasses import replace

import numpy as np
import pytest

from bench.actuators.laws import hold
from bench.identify.dynamics.first_pass import first_pass
from bench.identify.dynamics.presliding import turned
from bench.identify.dynamics.quantities import quantities
from bench.record.campaign import Array, Campaign
from bench.robot.nominal_dynamics import NominalDynamics
from tests.identify.dynamics.rigid_world import Friction, N, arm, drawn, fourier, robot, run_of, torque_of, truth_of

RATE, SIGMA = 200.0, 0.3  # [Hz], [Nm]
UNCERTAIN = {"mass": 0.05, "centre_of_mass_m": 0.01, "rotor_inertia": 0.15}


def dahl(position: Array, travel: Array) -> Array:
    """Return the share of its level that friction has, shape (T, n), sample by sample."""
    share = np.sign(position[1] - position[0])
    found = [share]
    for step in np.diff(position, axis=0):
        way = np.sign(step)
        share = way + (share - way) * np.exp(-np.abs(step) / travel)
        found.append(share)
    return np.array(found)


def test_friction_turns_over_its_travel() -> None:
    """After a turn z = 1 - 2 exp(-x / s); with a constant acceleration that lacks sqrt(2 pi s / a) in all."""
    acceleration, step = 0.8, 1e-5  # [rad/s^2], [s]
    time = np.arange(-0.3, 0.3, step)
    position = acceleration * time[:, None] ** 2 / 2
    travel = np.array([[2e-4], [5e-4]])
    after = time > 0
    found = turned(position, travel)
    for k, s in enumerate(travel[:, 0]):
        np.testing.assert_allclose(found[after, k, 0], 1 - 2 * np.exp(-position[after, 0] / s), atol=1e-3)
        area = np.sum(1 - found[after, k, 0]) * step
        assert area == pytest.approx(np.sqrt(2 * np.pi * s / acceleration), rel=1e-2)
        alike = 9 * np.pi / 32 * s  # travel of an element of `bench.friction` that lacks as much
        held = -hold(position[:, 0], 1 / alike, 1.0, 1.0)
        assert np.sum(1 - held[after]) * step == pytest.approx(area, rel=1e-2)


def moved(seed: int, travel: float) -> tuple[Campaign, NominalDynamics, NominalDynamics, Friction, Array]:
    """Return three runs of an arm whose friction turns late, the nominal and the true arm, friction and travels.

    Args:
        seed: Of everything.
        travel: About which those of the joints are drawn [rad]; 0: friction turns at once.
    """
    rng = np.random.default_rng(seed)
    nominal = robot(arm(), **UNCERTAIN)
    true = drawn(nominal, rng)
    friction = Friction(rng.uniform(4, 20, N), rng.uniform(2, 20, N), rng.normal(0, 1, N))
    travels = travel * np.exp(rng.uniform(-0.7, 0.7, N))
    runs = []
    for k in range(3):
        time, q, velocity, acceleration = fourier(rng, seconds=12.0, rate=RATE)
        torque = torque_of(true, q, velocity, acceleration) + friction.torque(velocity)
        if travel:
            torque += friction.coulomb * (dahl(q, travels) - np.sign(velocity))
        runs.append(run_of(f"run{k}", 100.0 * k, time, q, torque, SIGMA, rng))
    return Campaign("rigid", tuple(runs)), nominal, true, friction, travels


def test_friction_that_turns_late_is_no_inertia_and_its_travel_is_told() -> None:
    """Without it 11 of 16 rotors and 39 of 48 frictions of eight such arms lay in their intervals of 90 %."""
    inside: dict[str, list[bool]] = {"rotor": [], "friction": [], "travel": []}
    for seed in range(5):
        campaign, nominal, true, friction, travels = moved(seed, 2e-3)
        found = first_pass(campaign, nominal)
        assert found.has["presliding"] == (0, 1, 2)
        truth, told = truth_of(found, true, friction, 0.0), {one.name: one for one in quantities(found)}
        for one in told.values():
            low, high = one.interval(found.quantile(0.9))
            if one.told and one.name.startswith(("rotor", "Izz 1")):
                inside["rotor"].append(low <= one.combine @ truth <= high)
            elif one.name.startswith(("Coulomb friction", "viscous friction (")):
                inside["friction"].append(low <= one.combine @ truth <= high)
        for joint, travel in zip(found.joints, travels, strict=True):
            one = told[f"presliding travel ({joint})"]
            assert one.told
            assert one.value == pytest.approx(travel, rel=0.3)
            low, high = one.interval(found.quantile(0.9))
            inside["travel"].append(low <= travel <= high)
    for what, count in (("rotor", 10), ("friction", 30), ("travel", 15)):
        assert len(inside[what]) == count
        assert np.mean(inside[what]) >= 0.8, what  # 90 % of ten, less a standard deviation


def test_friction_that_turns_late_is_predicted_of_another_campaign() -> None:
    campaign, nominal, *_ = moved(1, 2e-3)
    last = campaign.runs[-1]
    found = first_pass(Campaign("rigid", campaign.runs[:-1]), nominal)
    assert found.has["presliding"]
    told = {one.name: one for one in quantities(found)}
    assert "presliding travel (base)" in told
    predicted = found.predict(Campaign("rigid", (last,))).rms("first_pass")
    at_once = replace(found, travel=np.full(N, 1e-9)).predict(Campaign("rigid", (last,))).rms("first_pass")
    assert np.all(predicted < 0.9 * at_once)
    assert np.all(predicted < 2 * SIGMA)


def test_friction_that_turns_at_once_is_taken_as_such() -> None:
    for seed in range(4):
        campaign, nominal, *_ = moved(seed, 0.0)
        found = first_pass(campaign, nominal)
        assert found.has["presliding"] == ()
        assert not [one.name for one in quantities(found) if "presliding" in one.name]
