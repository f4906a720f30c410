"""A spring on a lever about a joint: what a balancer that nobody stated carries of it, by `laws.balancer_waves`.

A balancer carries weight: beforehand it is as large as what the links as stated weigh at its joint, which is nothing at
an upright axis, where a base out of level does much the same. Each harmonic is half as large as the one before, for the
length of the spring that is free adds to what the lever makes.

Where the parent never tilts, sin q and cos q are what a first moment of the links weighs. The balancer has no inertia,
does not turn with later joints, and has harmonics; nothing else tells them apart but what is stated of masses.
"""

import numpy as np
from numpy.typing import NDArray

from bench.actuators.laws import BALANCER_HARMONICS, balancer_waves
from bench.identify.arm import Arm
from bench.record.campaign import Array

POSTURES = 100  # effort: of which the root mean square is right to a tenth


def balancer_columns(position: Array, hinges: NDArray[np.bool_]) -> Array:
    """Return the waves of each joint that turns, zeros of slides, shape (T, n, 6).

    Args:
        position: Shape (T, n) [rad] or [m].
        hinges: Shape (n,), joints that turn.
    """
    return np.where(hinges[:, None], balancer_waves(position), 0.0)


def balancer_sizes(arm: Arm) -> Array:
    """Return how large each of `balancer_columns` is beforehand, shape (n, 6) [Nm]: as what the links weigh.

    Args:
        arm: The links as stated.
    """
    n = len(arm.bodies.limits)
    limits = np.where(np.isfinite(arm.bodies.limits), arm.bodies.limits, [-np.pi, np.pi])
    postures = limits[:, 0] + np.ptp(limits, axis=1) * np.random.default_rng(0).random((POSTURES, n))
    weight = np.array([arm.inverse_dynamics(one, np.zeros(n), np.zeros(n)) for one in postures])
    weight = np.where(arm.bodies.is_hinge, np.sqrt(2 * np.mean(weight**2, axis=0)), 0.0)  # amplitude of a sine
    return np.outer(weight, np.repeat(0.5 ** np.arange(len(BALANCER_HARMONICS)), 2))
