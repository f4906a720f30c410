"""How well drives agree with the nominal model, whatever amounts of friction, payload and gas it lacks."""

import numpy as np
from scipy.optimize import nnls

from bench.diagnose.plausibility.drive_picture import DrivePicture
from bench.record.campaign import Array


def misfit(picture: DrivePicture) -> Array:
    """Return what a physical model leaves of every drive's torque, shape (n,), as a part of its mean square.

    The nominal model, with amounts of friction (one per drive), of payload and of gas that are zero or more. Friction
    holds a drive at rest up to its slack; only what goes beyond is left.
    """
    n, e = picture.missing.shape[1:]
    columns, values, slack, drive = [], [], [], []
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
        drive.append(np.full(len(own), j))
    if not columns:
        return np.zeros(n)
    stacked, response, of = np.concatenate(columns), np.concatenate(values), np.concatenate(drive)
    moving = np.concatenate(slack) == 0.0
    chosen = moving if np.any(moving) else np.full(len(moving), fill_value=True)
    size = np.maximum(np.linalg.norm(stacked[chosen], axis=0), 1e-12)
    amounts, _ = nnls(stacked[chosen] / size, response[chosen])
    beyond = np.maximum(np.abs(response - stacked / size @ amounts) - np.concatenate(slack), 0.0)
    return np.array([np.mean(beyond[of == j] ** 2) if np.any(of == j) else 0.0 for j in range(n)])
