"""A spring on a lever about a joint: what a balancer that nobody stated carries of it.

The spring is hooked to the link at a from the joint's axis and to the frame before it at b. At the angle q it is

    L = sqrt(a^2 + b^2 + 2 a b cos(q - q0)),   and needs the torque   -(F_0 + k (L - L_0)) a b sin(q - q0) / L

of the drive. Of a spring whose force is k L (free length zero) that is exactly A sin q + B cos q. Else 1 / L adds
harmonics, each smaller than the one before, of which the second and third are taken too: linear in six numbers. (At
b / a = 1/3 each is a fifth to a third of the one before; a half beforehand, for the length that is free adds to it.)

A balancer carries weight: beforehand it is as large as what the links as stated weigh at its joint, which is nothing at
an upright axis, where a base out of level does much the same.

Where the parent never tilts, sin q and cos q are what a first moment of the links weighs. The balancer has no inertia,
does not turn with later joints, and has harmonics; nothing else tells them apart but what is stated of masses.
"""

import numpy as np
from numpy.typing import NDArray

from bench.identify.arm import Arm
from bench.record.campaign import Array

HARMONICS = (1, 2, 3)  # declared: the fourth would be a third of the third at most
POSTURES = 100  # effort: of which the root mean square is right to a tenth


def balancer_columns(position: Array, hinges: NDArray[np.bool_]) -> Array:
    """Return sine and cosine of q, 2q and 3q of each joint that turns, zeros of slides, shape (T, n, 6).

    Args:
        position: Shape (T, n) [rad] or [m].
        hinges: Shape (n,), joints that turn.
    """
    waves = [wave(k * position) for k in HARMONICS for wave in (np.sin, np.cos)]
    return np.where(hinges[:, None], np.stack(waves, axis=2), 0.0)


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
    return np.outer(weight, np.repeat(0.5 ** np.arange(len(HARMONICS)), 2))
