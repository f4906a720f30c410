"""Friction that falls from run to run is said; what differs between runs in any other way is not."""

from dataclasses import replace

import numpy as np
import pytest

from bench.identify.dynamics.first_pass import first_pass
from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.quantities import quantities
from bench.identify.dynamics.warming import RATE, _chance, warming_of
from bench.record.campaign import Campaign
from bench.report.dynamics.notes import warming_notes
from tests.identify.dynamics.rigid_world import Friction, arm, fourier, recorded, robot, run_of, torque_of

FRICTION = Friction(np.array([12.0, 9.0, 4.0]), np.array([15.0, 10.0, 6.0]), np.array([0.5, -1.0, 0.8]))
SHORT = {"seconds": 10.0, "rate": 100.0}
FIVE = (0.12, 0.03, -0.02, -0.05, -0.08)  # of friction: as of drives that warm up within minutes


def recorded_with(shares: tuple[float, ...], faster: float = 0.0, seed: int = 4, apart: float = 100.0) -> Campaign:
    """Return runs in which all friction is larger by a share, one run after the other, so many seconds apart."""
    rng, nominal, runs = np.random.default_rng(seed), robot(arm()), []
    for k, share in enumerate(shares):
        time, q, velocity, acceleration = fourier(rng, base_hz=0.1 * (1 + faster * k), **SHORT)
        rubs = FRICTION.torque(velocity) - FRICTION.offset
        torque = torque_of(nominal, q, velocity, acceleration) + FRICTION.offset + (1 + share) * rubs
        runs.append(run_of(f"run{k}", apart * k, time, q, torque, 0.2, rng))
    return Campaign("rigid", tuple(runs))


def found_of(shares: tuple[float, ...], faster: float = 0.0, seed: int = 4, apart: float = 100.0) -> FirstPass:
    """Return the first pass of such runs."""
    return first_pass(recorded_with(shares, faster, seed, apart), robot(arm()), find_delay=False)


def test_friction_that_falls_from_run_to_run_is_said() -> None:
    """A stranger's arm of seven joints lost 6 % within ten minutes, and 0.26 of 0.06 Nm were left unexplained."""
    warming = warming_of(found_of(FIVE))
    assert warming is not None
    assert warming.runs == ("run0", "run1", "run2", "run3", "run4")
    fell = warming.scale[:, 0] - warming.scale[:, -1]
    np.testing.assert_allclose(fell, FIVE[0] - FIVE[-1], atol=0.02)
    assert np.all(warming.explained > 0.5)
    (sentence,) = warming_notes(warming)
    assert "Friction falls from run to run" in sentence


def test_friction_that_falls_is_a_term_of_the_fit() -> None:
    """Errors of held-out runs were its change, and a colder run was missed by no more than these were."""
    shares, apart = (0.16, 0.08, 0.0, -0.08, -0.16), 400.0
    found = found_of(shares, apart=apart)
    assert found.has["warming"] == (0, 1, 2)
    rates = [one for one in quantities(found) if one.name.startswith("friction that falls")]
    assert len(rates) == 3
    for one in rates:
        low, high = one.interval(found.quantile())
        assert low < 0.08 / apart * 3600 < high
        assert high - low < 0.2
    np.testing.assert_allclose(found.parameters[found.layout.of_drives("coulomb")], FRICTION.coulomb, rtol=0.03)
    left = found.held_out_rms()
    assert np.all(left < 0.3)  # noise of 0.2 Nm
    cold = found.predict(recorded_with((0.16,), seed=7)).rms("first_pass")
    assert np.all(cold > 2 * left)  # of another recording nobody knows how warm it is: friction of the middle is taken
    mean = found.predict(recorded_with((0.0,), seed=7)).rms("first_pass")
    assert np.all(mean < 1.3 * left)


def test_what_was_fitted_is_told_from_what_was_not() -> None:
    """Equations of a stretch that was fitted are the same when they are made again."""
    found = found_of(FIVE, apart=400.0)
    assert found.has["warming"]
    part = found.stretches[0]
    np.testing.assert_allclose(found.equations(part.samples).drives, part.drives, atol=1e-9)


@pytest.mark.parametrize("shares", [(0.0,) * 5, (-0.05, 0.1, -0.08, 0.06, -0.03), FIVE[::-1], FIVE[:3]])
def test_other_differences_between_runs_are_not_said(shares: tuple[float, ...]) -> None:
    """None, at random, rising, and of three runs, which have six orders only."""
    assert warming_of(found_of(shares)) is None


def test_runs_that_get_faster_say_nothing() -> None:
    assert warming_of(found_of(FIVE, faster=1.0)) is None


def test_runs_of_another_recording_are_none_of_it() -> None:
    campaign = recorded(robot(arm()), FRICTION, np.random.default_rng(3), runs=6, **SHORT)
    runs = tuple(replace(run, recording=f"day {k % 2}") for k, run in enumerate(campaign.runs))
    assert warming_of(first_pass(replace(campaign, runs=runs), robot(arm()), find_delay=False)) is None


def test_chance_is_the_share_of_orders(rng: np.random.Generator) -> None:
    """Of values without an order, at most one in a hundred passes, of few runs and of many."""
    for count in (5, 6, 9):
        passed = [_chance(rng.standard_t(3, (4, count))) <= RATE for _ in range(300)]
        assert np.mean(passed) <= 0.03
        assert _chance(np.arange(3 * count, dtype=float).reshape(3, count)) <= RATE
