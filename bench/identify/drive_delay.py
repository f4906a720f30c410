"""By how much readings of drives lag the angles."""

import numpy as np

from bench.identify.drive_fit import DriveFit
from bench.identify.drive_model import TINY, Motion, shifted
from bench.record.campaign import Array

BLOCKS = 8  # of the record, fitted one by one; their spread is the statistical error (assumed)
LATEST = 0.03  # [s], delay up to which is looked; drives report within a few control periods (assumed)
LAG_STEP = 1e-3  # [s] between the delays that are tried; a parabola through three of them tells the rest
CLEARLY_MOVING = 0.1  # of the top speed (assumed; friction that turns within 0.1 mrad was taken for 5 ms otherwise)


def sliding(motion: Motion) -> Array:
    """Return 1 where a drive moves clearly, 0 where it turns round, shape (T, n)."""
    speed = np.abs(motion.velocity)
    return np.where(speed > CLEARLY_MOVING * np.max(speed, axis=0), 1.0, 0.0)


def delay_of(
    time: Array, reading: Array, columns: Array, errors: Array, fit: DriveFit, counts: Array
) -> tuple[float, float]:
    """Return the delay with which least is left of readings, and its standard deviation [s].

    What may be wrong with the arm is free within its uncertainty, drive by drive: an inertia that nobody stated looks
    like a delay otherwise, where friction turns with the speed. Instants at which a drive turns round are left out:
    bristles bend before friction has turned, which looks like a delay of the readings.

    Args:
        time: Shape (T,) [s], even.
        reading: Shape (T, k).
        columns: Shape (k, T, c), as of `model_columns`.
        errors: Shape (k, T, p), as of `arm_errors`.
        fit: Of the readings as they are.
        counts: Shape (T, k), 1 for the instants that count, else 0.
    """
    lags = np.arange(-LATEST, LATEST + 1e-9, LAG_STEP)
    seen = np.stack([counts * shifted(time, reading, lag) for lag in lags], axis=2)
    parts = [slice(None), *(slice(rows[0], rows[-1] + 1) for rows in np.array_split(np.arange(len(time)), BLOCKS))]
    left = np.zeros((len(parts), len(lags)))
    for j, slope in enumerate(fit.slope):
        design = counts[:, j, None] * np.concatenate([columns[j][:, :-1], slope * errors[j]], axis=1)
        weight = np.r_[np.zeros(columns.shape[2] - 1), np.sqrt(fit.noise[j] / fit.prior)]
        for i, rows in enumerate(parts):
            left[i] += _left(design[rows], weight, seen[rows, j])
    whole, *cut = [_lowest(lags, misfits) for misfits in left]
    return whole, float(np.std(cut, ddof=1) / np.sqrt(BLOCKS))


def _left(design: Array, weight: Array, seen: Array) -> Array:
    """Return the logarithm of what is left of a reading with each lag, shape (L,); weights hold coefficients."""
    q = np.linalg.qr(np.concatenate([design, np.diag(weight)]))[0]
    target = np.concatenate([seen, np.zeros((len(weight), seen.shape[1]))])
    return np.asarray(np.log(np.maximum(np.sum((target - q @ (q.T @ target)) ** 2, axis=0), TINY)))


def _lowest(lags: Array, misfits: Array) -> float:
    """Return where a parabola through the lowest three values has its foot."""
    k = int(np.clip(np.argmin(misfits), 1, len(lags) - 2))
    before, here, after = misfits[k - 1 : k + 2]
    bend = before - 2 * here + after
    return float(lags[k] + (0.5 * (before - after) / bend if bend > 0 else 0.0) * (lags[1] - lags[0]))
