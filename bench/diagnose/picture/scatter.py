"""What no replay can predict: noise of the instruments, and where static friction came to rest.

A joint at rest holds any friction torque up to its level; which one depends on how the servo settled and on what shook.
The replay knows the side of the approach, the rest is scatter: a part that stays over a visit or a run, and a part
anew at every rest. Dividing by it (whitening) makes all quantities comparable and independent.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from bench.diagnose.picture.torque_response import TorqueResponse
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

# Shares of the Coulomb level, from the virtual robot in time (README.md): how far friction at rest lies from what the
# path of commands and loads alone would leave.
MOTOR_REST, LINK_REST = 0.8, 0.15  # anew at every rest
MOTOR_VISIT, LINK_VISIT = 2.0, 0.6  # the same for a visit; a motor may have let go of all it held
STANDING = 1.0  # a joint that stands while others move: anywhere between its two levels, changing slowly
STANDING_REST = 0.3  # and by so much anew at every instant
SLOWNESS = 5  # polynomials over the run that describe the slow change


@dataclass(frozen=True, eq=False)
class Whitening:
    """A linear map after which what cannot be predicted is standard normal, for one segment.

    Attributes:
        rows: Shape (T * c,) bool; entries that were measured.
        factors: Shape (T, c, c), inverse Cholesky factors, instant by instant.
        modes: Shape (m, r), orthonormal, what is common to the segment, in whitened space.
        shrink: Shape (r,), by how much each mode is taken back.
    """

    rows: NDArray[np.bool_]
    factors: Array
    modes: Array
    shrink: Array

    def __call__(self, values: Array) -> Array:
        """Return whitened values, shape (m, ...), of values of shape (T, c, ...); entries not measured are dropped."""
        shape = values.shape
        white = (self.factors @ np.nan_to_num(values.reshape(*shape[:2], -1))).reshape(shape[0] * shape[1], -1)
        whitened: Array = self.settled(white[self.rows])
        return whitened.reshape(-1, *shape[2:])

    def settled(self, white: Array) -> Array:
        """Return values, shape (m, k), that were whitened instant by instant, without what is common to the segment."""
        if not len(self.shrink):
            return white
        settled: Array = white - self.modes @ (self.shrink[:, None] * (self.modes.T @ white))
        return settled


def whitening_of(
    compiled: CompiledRobot, segment: Segment, response: TorqueResponse, quantities: tuple[Quantity, ...]
) -> Whitening:
    """Return how a segment is whitened."""
    length, c = segment.observed.shape
    measured = np.isfinite(segment.observed) & np.isfinite(segment.sigma)
    if not segment.is_static:  # what a motor pays that stands says nothing about its load
        pays = np.array([quantity.is_drive and bool(segment.standing[quantity.index]) for quantity in quantities])
        measured &= ~pays
    n = compiled.n_joints
    levels = np.concatenate([compiled.link_coulomb, compiled.motor_coulomb])
    if segment.is_static:
        once, lasting = np.repeat([LINK_REST, MOTOR_REST], n), np.repeat([LINK_VISIT, MOTOR_VISIT], n)
        slow = np.asarray(np.ones((length, 1)), dtype=np.float64)
    else:
        standing = np.tile(segment.standing, 2)
        once, lasting = STANDING_REST * standing, STANDING * standing
        slow = np.asarray(legendre.legvander(np.linspace(-1, 1, length), SLOWNESS - 1), dtype=np.float64)
    spread = np.concatenate([response.link, response.motor], axis=2) * levels  # (T, c, 2n), a whole level
    spread = np.where(measured[:, :, None], spread, 0.0)
    noise = np.where(measured, segment.sigma, 1.0)
    covariance = (spread * once**2) @ spread.transpose(0, 2, 1)
    error = segment.acceleration_error[:, None, :]
    for inertial in (
        response.link * response.link_inertia[:, None] * error,
        response.motor * response.rotor_inertia * error,
    ):
        seen = np.where(measured[:, :, None], inertial, 0.0)
        covariance += seen @ seen.transpose(0, 2, 1)
    covariance[:, np.arange(c), np.arange(c)] += noise**2
    factors = np.linalg.inv(np.linalg.cholesky(covariance))
    rows = measured.reshape(-1)
    part = (spread * lasting)[:, :, lasting * levels > 0]
    common = np.concatenate([factors @ (part * slow[:, m, None, None]) for m in range(slow.shape[1])], axis=2)
    common = common.reshape(length * c, -1)[rows]
    if common.shape[1] == 0 or not np.any(common):
        return Whitening(rows, factors, np.zeros((int(rows.sum()), 0)), np.zeros(0))
    modes, size, _ = np.linalg.svd(common, full_matrices=False)
    kept = size > 1e-9 * size[0]
    return Whitening(rows, factors, modes[:, kept], 1 - 1 / np.sqrt(1 + size[kept] ** 2))
