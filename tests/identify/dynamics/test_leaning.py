"""A base that is out of level is said, with the gravity to write; a level one is not."""

from dataclasses import replace

import numpy as np
import pytest

from bench.identify.dynamics.first_pass import first_pass
from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.leaning import leaning_of
from bench.record.campaign import Campaign
from bench.report.dynamics.notes import notes_of
from bench.robot.bodies import read_only
from tests.identify.dynamics.rigid_world import GRAVITY, Friction, arm, drawn, fourier, robot, run_of, torque_of

FRICTION = Friction(np.array([12.0, 9.0, 4.0]), np.array([15.0, 10.0, 6.0]), np.array([0.5, -1.0, 0.8]))
CRUDE = {"mass": 0.1, "centre_of_mass_m": 0.01, "rotor_inertia": 0.2}


def found_of(lean: tuple[float, float], seed: int) -> FirstPass:
    """Return the first pass of an arm whose floor leans by so much [rad], stated level and off by what is stated."""
    rng, nominal, runs = np.random.default_rng(seed), robot(arm(), **CRUDE), []
    true = drawn(nominal, rng)
    gravity = np.array(GRAVITY) + 9.81 * np.array([*lean, 0.0])
    true = replace(true, bodies=replace(true.bodies, gravity=read_only(gravity)))
    for k in range(3):
        time, q, velocity, acceleration = fourier(rng, seconds=20.0, rate=100.0)
        torque = torque_of(true, q, velocity, acceleration) + FRICTION.torque(velocity)
        runs.append(run_of(f"run{k}", 100.0 * k, time, q, torque, 0.2, rng))
    return first_pass(Campaign("rigid", tuple(runs)), nominal, find_delay=False)


@pytest.mark.parametrize("lean", [(0.006, -0.004), (0.0, 0.01)])
def test_a_floor_that_leans_is_said(lean: tuple[float, float]) -> None:
    """Of two loaders, 0.4 and 0.7 degrees out of level, that was nearly all that was left of the slewing drive."""
    found = found_of(lean, 4)
    one = leaning_of(found)
    assert one
    assert "base" in one.explained
    np.testing.assert_allclose(one.gravity[:2] / 9.81, lean, atol=3 * one.sigma)
    assert one.sigma < 0.2 * one.lean
    (note,) = [note for note in notes_of(found, {}) if "lean" in note]
    assert "into <option> of the MJCF" in note


@pytest.mark.parametrize("seed", range(3))
def test_a_level_floor_is_not(seed: int) -> None:
    assert leaning_of(found_of((0.0, 0.0), seed)) is None
