"""How well drives agree with the nominal model, whatever amounts of friction, payload and gas it lacks."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from bench.diagnose.plausibility.drive_picture import DrivePicture
from bench.record.campaign import Array

# declared: times the friction of a drive in motion, that it may hold at rest; Stribeck friction is half more
HOLDS = 2.0


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
    own = 3 if zeros else 2
    parts = np.zeros((*picture.observed.shape, e + own * n))
    least = np.zeros(e + own * n)
    for j in range(n):
        v, first = picture.velocity[:, j], e + own * j
        parts[:, j, :e] = picture.missing[:, j]
        parts[:, j, first : first + own] = np.stack([np.sign(v), v, np.ones(len(v))], axis=1)[:, :own]
        least[first : first + own] = [*-picture.spare[:, j], -np.inf][:own]
    seen = np.isfinite(picture.observed) & (powers > 0)
    if by is not None:
        seen &= by[:, None]
    if not np.any(seen):
        return picture
    moving = seen & ~(picture.standing & (picture.slack > 0))
    chosen = moving if np.any(moving) else seen
    power = np.broadcast_to(powers, seen.shape)[chosen]
    stacked, response = parts[chosen] / power[:, None], (picture.observed - picture.model)[chosen] / power
    amounts = _least_squares(stacked, response, least)
    held = HOLDS * (picture.level + amounts[e::own])
    slack = np.where(held > 0, np.minimum(held, picture.slack), picture.slack)
    return replace(picture, model=picture.model + parts @ amounts, missing=picture.missing[:, :, :0], slack=slack)


def _least_squares(columns: Array, response: Array, least: Array) -> Array:
    """Return amounts, shape (k,), that are not below the least and make of columns, shape (m, k), the response best.

    By the triangular factor of all of it, which is as small as there are amounts, and in amounts from the least on
    (free ones to either side) that are not negative: Lawson and Hanson (1974), chapter 23.
    """
    bounded = np.isfinite(least)
    response = response - columns[:, bounded] @ least[bounded]
    both = np.concatenate([columns, -columns[:, ~bounded], response[:, None]], axis=1)
    size = np.maximum(np.linalg.norm(both, axis=0), 1e-12)
    root: Array = np.asarray(np.linalg.qr(both / size, mode="r"))
    amounts = nnls(root[:, :-1], root[:, -1])[0] * size[-1] / size[:-1]
    found: Array = amounts[: len(least)] + np.where(bounded, least, 0.0)
    found[~bounded] -= amounts[len(least) :]
    return found


def _powers(picture: DrivePicture) -> Array:
    """Return the root of the mean square of every drive's torque, shape (n,); zero where none was measured."""
    seen = np.isfinite(picture.observed)
    squares = np.where(seen, picture.observed, 0.0) ** 2
    powers: Array = np.sqrt(squares.sum(axis=0) / np.maximum(seen.sum(axis=0), 1))
    return powers
