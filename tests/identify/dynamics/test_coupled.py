"""A motor that turns with two joints is said, and no other."""

import numpy as np
import pytest

from bench.identify.dynamics.coupled import coupled_motors
from bench.identify.dynamics.first_pass import first_pass
from bench.identify.dynamics.found import FirstPass
from bench.record.campaign import Campaign
from bench.report.dynamics.notes import notes_of
from tests.identify.dynamics.rigid_world import Friction, N, arm, fourier, robot, run_of, torque_of

FRICTION = Friction(np.array([12.0, 9.0, 4.0]), np.array([15.0, 10.0, 6.0]), np.array([0.5, -1.0, 0.8]))


def found_of(ratio: float, seed: int) -> FirstPass:
    """Return the first pass of an arm whose third motor turns by q_3 + ratio q_2."""
    rng, nominal, runs = np.random.default_rng(seed), robot(arm()), []
    turns = np.eye(N)
    turns[2, 1] = ratio
    for k in range(3):
        time, q, velocity, acceleration = fourier(rng, seconds=10.0, rate=100.0)
        joint = torque_of(nominal, q, velocity, acceleration) - nominal.rotor_inertia * acceleration
        motor = joint @ np.linalg.inv(turns) + acceleration @ turns.T * nominal.rotor_inertia  # same power
        runs.append(run_of(f"run{k}", 100.0 * k, time, q, motor + FRICTION.torque(velocity @ turns.T), 0.2, rng))
    return first_pass(Campaign("rigid", tuple(runs)), nominal, find_delay=False)


@pytest.mark.parametrize("ratio", [1.0, -0.8])
def test_a_motor_that_turns_with_two_joints_is_said(ratio: float) -> None:
    """Half of the torque of a stranger's joint 6 was left unexplained, and nothing said of it."""
    found = found_of(ratio, 4)
    (one,) = coupled_motors(found)
    assert (one.joint, one.other) == ("elbow", "shoulder")
    assert one.ratio == pytest.approx(ratio, abs=0.13)
    assert any("The motor of elbow seems to turn with shoulder as well" in note for note in notes_of(found, (), {}))


@pytest.mark.parametrize("seed", range(4))
def test_motors_of_one_joint_each_are_not(seed: int) -> None:
    assert coupled_motors(found_of(0.0, seed)) == ()
