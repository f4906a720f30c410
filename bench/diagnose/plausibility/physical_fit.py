"""How well drives agree with the nominal model, whatever amounts of friction, payload and gas it lacks."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from bench.diagnose.plausibility.drive_picture import DrivePicture
from bench.record.campaign import Array

# declared: times the friction of a drive in motion, that it may hold at rest; Stribeck friction is half more
HOLDS = 2.0
FITS = 0.05  # assumed: of the mean square of a drive's torque; a model that leaves less fits, most defects included
FAR_BETTER = 0.1  # assumed: of the squares that a reading leaves; what leaves less is the right reading
HALF = 0.5  # exact: the greater part


def misfit(picture: DrivePicture) -> Array:
    """Return what a physical model leaves of every drive's torque, shape (n,), as a part of its mean square."""
    left = left_over(picture)
    seen = np.isfinite(left)
    means: Array = np.where(seen, left, 0.0).sum(axis=0) / np.maximum(seen.sum(axis=0), 1)
    return means


def left_over(picture: DrivePicture) -> Array:
    """Return the square of what a physical model leaves, shape (T, n), over the mean square of the drive's torque.

    nan where there is nothing to explain. Friction holds a drive at rest up to its slack; only what goes beyond is
    left.
    """
    power, whole = _powers(picture), replace(completed(picture), slack=picture.slack)
    left: Array = np.where(power > 0, (beyond(whole) / np.where(power > 0, power, 1.0)) ** 2, np.nan)
    return left


def beyond(picture: DrivePicture) -> Array:
    """Return by how much drives paid more or less than the model needs and friction may hold, shape (T, n) [Nm]."""
    left = np.abs(picture.observed - picture.model)
    past: Array = np.maximum(left - np.where(picture.standing, picture.slack, 0.0), 0.0)
    return past


def completed(picture: DrivePicture, by: NDArray[np.bool_] | None = None, *, zeros: bool = False) -> DrivePicture:
    """Return a picture whose model has what the nominal one lacks, so that nothing is missing.

    Amounts of payload and of gas that are zero or more, and of friction of each drive, as fit all drives best; of
    stated friction as much may be too much as it is uncertain. Drives that stand tell something only where none moves.

    Args:
        picture: What the drives did.
        by: Instants to fit, shape (T,); None: all.
        zeros: Whether channels may have zeros of their own, too.
    """
    n, e = picture.missing.shape[1:]
    powers = _powers(picture)
    parts = np.zeros((*picture.observed.shape, e + 4 * n))
    least = np.zeros(e + 4 * n)
    for j in range(n):
        v = picture.velocity[:, j]
        parts[:, j, :e] = picture.missing[:, j]
        for k, part in enumerate((np.sign(v), v, float(zeros), -float(zeros))):
            parts[:, j, e + 4 * j + k] = part
        least[e + 4 * j : e + 4 * j + 2] = -picture.spare[:, j]
    seen = np.isfinite(picture.observed) & (powers > 0)
    if by is not None:
        seen &= by[:, None]
    if not np.any(seen):
        return picture
    moving = seen & ~(picture.standing & (picture.slack > 0))
    chosen = moving if np.any(moving) else seen
    power = np.broadcast_to(powers, seen.shape)[chosen]
    stacked, response = parts[chosen] / power[:, None], (picture.observed - picture.model)[chosen] / power
    size = np.maximum(np.linalg.norm(stacked, axis=0), 1e-12)
    amounts = least + nnls(stacked / size, response - stacked @ least)[0] / size
    held = HOLDS * (picture.level + amounts[e::4])
    slack = np.where(held > 0, np.minimum(held, picture.slack), picture.slack)
    return replace(picture, model=picture.model + parts @ amounts, missing=picture.missing[:, :, :0], slack=slack)


def _powers(picture: DrivePicture) -> Array:
    """Return the root of the mean square of every drive's torque, shape (n,); zero where none was measured."""
    seen = np.isfinite(picture.observed)
    squares = np.where(seen, picture.observed, 0.0) ** 2
    powers: Array = np.sqrt(squares.sum(axis=0) / np.maximum(seen.sum(axis=0), 1))
    return powers
