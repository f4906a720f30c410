"""How well a stiffness that was identified without K_C predicts deflections elsewhere: Eqs. (43) to (46), Fig. 5.

The stiffness identified at one pose of the zone predicts the deflection at every pose of the grid by Eq. (35); the true
deflection has K_C, Eq. (17). The map shows the worst of these predictions at the pose of identification. (At that pose
itself Eq. (35) returns the deflection that the stiffness was made from, and there is nothing to see.)
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.identify.arm import Arm
from bench.identify.complementary_map import ComplementaryMap
from bench.robot.bodies import Array, Point, read_only


@dataclass(frozen=True)
class PredictionError:
    """Largest error over the grid, by the pose at which the stiffness was identified; nan outside the zone.

    Attributes:
        position: Shape (a, b), eps_P, Eq. (45), relative to the true deflection.
        orientation: Shape (a, b) [rad], eps_O, Eq. (46).
    """

    position: Array
    orientation: Array


def prediction_error(
    arm: Arm, complementary: ComplementaryMap, reference_point: str | Point, zone: NDArray[np.bool_], every: int = 1
) -> PredictionError:
    """Return the prediction errors of the stiffness identified at each pose of a zone.

    Args:
        arm: The arm.
        complementary: The map.
        reference_point: Point whose deflection is predicted.
        zone: Shape (a, b), poses of identification, such as `complementary.zone()`.
        every: The deflection is predicted at every such grid point along either axis, beginning with the first.
    """
    compliance = 1 / complementary.identified[zone]
    sampled = (slice(None, None, every), slice(None, None, every))
    n = arm.n_joints
    jacobian = arm.jacobian(complementary.grid.angles[sampled].reshape(-1, n), reference_point)
    torque = complementary.torque[sampled].reshape(-1, n)
    deflection = complementary.deflection[sampled].reshape(-1, n)
    eps_p, eps_o = np.zeros(len(compliance)), np.zeros(len(compliance))
    for j, gamma, true in zip(jacobian, torque, (jacobian @ deflection[..., None])[..., 0], strict=True):
        error = (j * gamma) @ compliance.T - true[:, None]
        np.maximum(eps_p, np.sqrt(np.sum(error[:3] ** 2, axis=0)) / np.linalg.norm(true[:3]), out=eps_p)
        np.maximum(eps_o, np.abs(error[3:]).max(axis=0), out=eps_o)
    return PredictionError(_on_grid(zone, eps_p), _on_grid(zone, eps_o))


def _on_grid(zone: NDArray[np.bool_], values: Array) -> Array:
    full = np.full(zone.shape, np.nan)
    full[zone] = values
    return read_only(full)
