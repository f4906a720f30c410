"""Friction over speed from opposite traverses, Eq. (48)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.errors import InputError
from bench.identify.traverses import Traverse
from bench.record.campaign import Array


@dataclass(frozen=True)
class FrictionOverSpeed:
    """Friction of one joint, both sides of the elastic element together: coulomb + viscous * speed.

    The noise of the current is all that sigma holds; an error of the torque constant scales everything.

    Attributes:
        speed: Shape (R,) [rad/s], one per traverse.
        torque: Shape (R,) [Nm], mean of half the difference over each traverse.
        sigma: Shape (R,) [Nm].
        coulomb: Level at no speed [Nm].
        viscous: [Nm s/rad].
        covariance: Shape (2, 2), of (coulomb, viscous).
    """

    speed: Array
    torque: Array
    sigma: Array
    coulomb: float
    viscous: float
    covariance: Array


def friction_over_speed(traverses: Sequence[Traverse]) -> FrictionOverSpeed:
    """Fit a line to the friction of traverses of one joint.

    Raises:
        InputError: They are of different joints, or all at one speed.
    """
    speed = np.array([t.speed for t in traverses])
    if len({t.joint for t in traverses}) != 1 or np.ptp(speed) < 1e-3 * speed.max():
        raise InputError("friction over speed: needs traverses of one joint at two speeds or more.")
    weights = [1 / t.sigma**2 for t in traverses]
    torque = np.array([np.average(t.friction, weights=w) for t, w in zip(traverses, weights, strict=True)])
    sigma = np.array([w.sum() ** -0.5 for w in weights])
    rows = np.column_stack([np.ones_like(speed), speed]) / sigma[:, None]
    covariance = np.linalg.inv(rows.T @ rows)
    coulomb, viscous = covariance @ rows.T @ (torque / sigma)
    return FrictionOverSpeed(speed, torque, sigma, float(coulomb), float(viscous), covariance)
