"""How well drives agree with the nominal model, whatever amounts of friction, payload and gas it lacks."""

import numpy as np
from scipy.optimize import nnls

from bench.diagnose.plausibility.drive_picture import DrivePicture
from bench.record.campaign import Array


def misfit(picture: DrivePicture) -> Array:
    """Return what a physical model leaves of every drive's torque, shape (n,), as a part of its mean square."""
    left = left_over(picture)
    seen = np.isfinite(left)
    means: Array = np.where(seen, left, 0.0).sum(axis=0) / np.maximum(seen.sum(axis=0), 1)
    return means


def left_over(picture: DrivePicture) -> Array:
    """Return the square of what a physical model leaves, shape (T, n), over the mean square of the drive's torque.

    nan where there is nothing to explain. The nominal model, with amounts of friction (one per drive), of payload and
    of gas that are zero or more. Friction holds a drive at rest up to its slack; only what goes beyond is left.
    """
    n, e = picture.missing.shape[1:]
    left = np.full(picture.observed.shape, np.nan)
    columns, values, slack, places = [], [], [], []
    for j in range(n):
        seen = np.isfinite(picture.observed[:, j])
        power = float(np.sqrt(np.mean(picture.observed[seen, j] ** 2))) if np.any(seen) else 0.0
        if power == 0.0:
            continue
        own, v = np.zeros((int(seen.sum()), e + 2 * n)), picture.velocity[seen, j]
        own[:, :e] = picture.missing[seen, j]
        own[:, e + 2 * j], own[:, e + 2 * j + 1] = np.sign(v), v
        columns.append(own / power)
        values.append((picture.observed[seen, j] - picture.model[seen, j]) / power)
        slack.append(np.where(picture.standing[seen, j], picture.slack[j] / power, 0.0))
        places.append((np.flatnonzero(seen), np.full(len(own), j)))
    if not columns:
        return left
    stacked, response = np.concatenate(columns), np.concatenate(values)
    moving = np.concatenate(slack) == 0.0
    chosen = moving if np.any(moving) else np.full(len(moving), fill_value=True)
    size = np.maximum(np.linalg.norm(stacked[chosen], axis=0), 1e-12)
    amounts, _ = nnls(stacked[chosen] / size, response[chosen])
    beyond = np.maximum(np.abs(response - stacked / size @ amounts) - np.concatenate(slack), 0.0)
    rows, drives = (np.concatenate(place) for place in zip(*places, strict=True))
    left[rows, drives] = beyond**2
    return left
