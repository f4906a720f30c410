"""Position and orientation deflection of the flange from the positions of three or more reflectors on it."""

from dataclasses import dataclass

import numpy as np

from bench.errors import InputError
from bench.identify.readings import StaticReadings
from bench.robot.bodies import Array

FLAT = 1e-3  # smallest to largest spread of the reflectors, below which they stand in one line


@dataclass(frozen=True)
class PoseDeflection:
    """Delta X of each state against the first unloaded state of its series, at the first reflector.

    Attributes:
        change: Shape (m, 6) [m, rad], position then rotation vector, base axes.
        covariance: Shape (m, 6, 6), from the reading of the state alone.
    """

    change: Array
    covariance: Array


def pose_deflection(readings: StaticReadings) -> PoseDeflection:
    """Return Delta X by least squares: reflector k moves by Delta P + Delta phi x (p_k - p_1).

    The first reflector stays where it is; the others are carried from nest to nest in every state, and their
    placement error does not average over the repeats of a state.

    Raises:
        InputError: The reflectors stand in one line, so that they do not see a rotation about it.
    """
    points = readings.reflectors
    before = points[readings.first_of_series]
    arms = before - before[:, :1]
    spread = np.linalg.svd(arms, compute_uv=False)
    if np.any(spread[:, 1] < FLAT * spread[:, 0]):
        raise InputError(
            "methods 'force-pose' and 'force-paper': the reflectors stand in one line; put one of them off it."
        )
    m, r, _ = points.shape
    design = np.zeros((m, r, 3, 6))
    design[..., :3] = np.eye(3)
    design[..., 3:] = np.cross(np.eye(3), arms[:, :, None, :]).swapaxes(-1, -2)
    variance = np.tile(readings.sigma_reflector**2 / readings.n_repeats[:, None], (1, r))
    variance[:, 1:] += readings.systematic.placement**2
    weight = 1 / np.repeat(variance, 3, axis=1)
    flat = design.reshape(m, 3 * r, 6)
    weighted = flat.transpose(0, 2, 1) * weight[:, None, :]
    covariance = np.array(np.linalg.inv(weighted @ flat))
    moved = (points - before).reshape(m, 3 * r, 1)
    return PoseDeflection((covariance @ weighted @ moved)[..., 0], covariance)
