"""Torques without friction are said to be those of sensors behind the gears; those of motors are not."""

import numpy as np
import pytest

from bench.diagnose.baseline.first_look import FirstLook
from bench.identify.dynamics.behind_gears import LEAST_FRICTION, friction_share
from bench.identify.dynamics.first_pass import first_pass
from bench.identify.dynamics.found import FirstPass
from bench.record.campaign import Campaign
from bench.report.diagnosis.baseline import first_lines
from bench.report.dynamics.notes import notes_of
from tests.identify.dynamics.rigid_world import Friction, arm, fourier, robot, run_of, torque_of

FRICTION = Friction(np.array([12.0, 9.0, 4.0]), np.array([15.0, 10.0, 6.0]), np.zeros(3))
SAID = "next to no friction"


def found_of(share: float, *, is_motor: bool, seed: int) -> FirstPass:
    """Return the first pass of an arm with a share of that friction, by what motors pay or by sensors behind gears."""
    rng, nominal, runs = np.random.default_rng(seed), robot(arm()), []
    for k in range(3):
        time, q, velocity, acceleration = fourier(rng, seconds=10.0, rate=100.0)
        torque = torque_of(nominal, q, velocity, acceleration) + share * FRICTION.torque(velocity)
        if not is_motor:
            torque = torque - nominal.rotor_inertia * acceleration
        runs.append(run_of(f"run{k}", 100.0 * k, time, q, torque, 0.2, rng))
    return first_pass(Campaign("rigid", tuple(runs)), nominal, find_delay=False)


@pytest.mark.parametrize("seed", range(3))
def test_torques_without_friction_are_said(seed: int) -> None:
    """A stranger's joint torque sensors were taken for motors without friction and rotors, and nothing said so."""
    found = found_of(0.0, is_motor=False, seed=seed)
    share = friction_share(found)
    assert share is not None
    assert share < LEAST_FRICTION
    assert any(SAID in note for note in notes_of(found, (), {}))
    assert any(SAID in line for line in first_lines(FirstLook(found, 1.0)))


@pytest.mark.parametrize("share", [0.3, 1.0])
def test_torques_of_motors_are_not(share: float) -> None:
    found = found_of(share, is_motor=True, seed=1)
    assert friction_share(found) is None
    assert not any(SAID in note for note in notes_of(found, (), {}))
