"""Angles that the range of a joint tells the direction of are not turned by what no file has."""

from dataclasses import replace

import numpy as np

from bench.identify.directions import kept_by_range
from bench.identify.turned_angles import TurnedAngles, turned_angles
from bench.record.campaign import Array
from bench.robot.bodies import read_only
from tests.identify.dynamics.rigid_world import Friction, N, arm, fourier, robot, torque_of

MIDDLE = np.array([0.0, 0.7, 0.6])
FRICTION = Friction(np.array([20.0, 15.0, 8.0]), np.array([30.0, 20.0, 10.0]), np.zeros(N))
SPRING = 900.0  # [Nm/rad], of the shoulder, which helps to hold it up; the drawing does not have it


def told(limits: Array) -> TurnedAngles:
    """Return the directions of an arm whose boom a spring holds up."""
    nominal = robot(replace(arm(), limits=read_only(limits)))
    time, q, velocity, acceleration = fourier(np.random.default_rng(0), seconds=20.0, rate=50.0)
    q = MIDDLE + 0.5 * q
    torque = torque_of(nominal, q, 0.5 * velocity, 0.5 * acceleration) + FRICTION.torque(0.5 * velocity)
    torque[:, 1] += SPRING * (q[:, 1] - 0.1)
    return turned_angles(nominal, time, q, torque, np.ones(N, dtype=np.bool_))


def test_no_joint_is_turned_out_of_its_range() -> None:
    """Boom, stick and telescope of a stranger, held by gas that no file had, were turned to where they never can be."""
    found = told(np.array([[-2.0, 2.0], [-0.1, 1.6], [-0.1, 1.5]]))
    assert not np.any(found.turned)
    assert found.beyond.tolist() == [False, True, True]


def test_without_a_range_that_tells_torques_decide() -> None:
    found = told(np.array([[-2.0, 2.0], [-2.0, 2.0], [-2.0, 2.0]]))
    assert found.turned.tolist() == [False, True, True]
    assert not np.any(found.beyond)


def test_a_range_tells_of_joints_that_stay_within_it() -> None:
    position = np.linspace(0.1, 1.5, 9)[:, None] * [1.0, 1.0, -1.0, 1.0]
    limits = np.array([[-2.0, 2.0], [0.0, 2.0], [0.0, 2.0], [0.0, 0.0]])
    assert kept_by_range(limits, position).tolist() == [False, True, False, False]
    assert not np.any(kept_by_range(limits, position + 5.0))  # zeros that are elsewhere
