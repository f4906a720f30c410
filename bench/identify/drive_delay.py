"""By how much readings of drives lag the angles."""

import numpy as np

from bench.identify.drive_fit import DriveFit
from bench.identify.drive_model import TINY, Motion, shifted
from bench.record.campaign import Array

BLOCKS = 8  # of the record, fitted one by one; their spread is the statistical error (assumed)
LATEST = 0.03  # [s], delay up to which is looked; drives report within a few control periods (assumed)
LAG_STEP = 1e-3  # [s] between the delays that are tried; a parabola through three of them tells the rest
LEAST_VARIANCE = LAG_STEP**2 / 12 / BLOCKS  # exact: of the mean of blocks, each known to a step
CLEARLY_MOVING = 0.1  # of the top speed (assumed; friction that turns within 0.1 mrad was taken for 5 ms otherwise)


def sliding(motion: Motion) -> Array:
    """Return 1 where a drive moves clearly, 0 where it turns round or rests, shape (T, n); all 1 if it never moves."""
    speed = np.abs(motion.velocity)
    return np.where(speed >= CLEARLY_MOVING * np.max(speed, axis=0), 1.0, 0.0)


def delay_of(
    time: Array, reading: Array, columns: Array, errors: Array, fit: DriveFit, counts: Array
) -> tuple[float, float]:
    """Return the delay with which least is left of readings, and its standard deviation [s].

    What may be wrong with the arm is free within its uncertainty, drive by drive: an inertia that nobody stated looks
    like a delay otherwise, where friction turns with the speed. Instants at which a drive turns round are left out:
    bristles bend before friction has turned, which looks like a delay of the readings.

    All drives are read by one clock. Where they differ by more than blocks of the record scatter, the model is wrong in
    some of them (an arm that rings), and that is in the standard deviation: about what all say together, with weights
    that count by how much drives differ (DerSimonian and Laird, Meta-analysis in clinical trials, 1986; the variance is
    that of Hartung and Knapp, 2001, for there are few drives).

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
    left = np.zeros((len(fit.slope), len(parts), len(lags)))
    for j, slope in enumerate(fit.slope):
        design = counts[:, j, None] * np.concatenate([columns[j][:, :-1], slope * errors[j]], axis=1)
        weight = np.r_[np.zeros(columns.shape[2] - 1), np.sqrt(fit.noise[j] / fit.prior)]
        for i, rows in enumerate(parts):
            left[j, i] = _left(design[rows], weight, seen[rows, j])
    whole, variance = _in_blocks(lags, left.sum(axis=0))
    each, variances = np.array([_in_blocks(lags, misfits) for misfits in left]).T
    found = (lags[1] < each) & (each < lags[-2])  # a drive that fits best at an end says nothing
    return whole, float(np.sqrt(max(variance, _between(each[found] - whole, variances[found]))))


def _in_blocks(lags: Array, misfits: Array) -> tuple[float, float]:
    """Return the delay that leaves least of all, and the variance of the mean of those of blocks."""
    whole, *cut = (_lowest(lags, one) for one in misfits)
    return whole, max(float(np.var(cut, ddof=1)) / BLOCKS, LEAST_VARIANCE)


def _between(off: Array, variances: Array) -> float:
    """Return the variance of a mean about which drives differ, by how far each is off and its own variance."""
    more = len(off) - 1
    if more < 1:
        return 0.0
    weight = 1 / variances
    excess = weight @ (off - weight @ off / weight.sum()) ** 2 - more
    between = max(0.0, float(excess / (weight.sum() - weight @ weight / weight.sum())))
    weight = 1 / (variances + between)
    return float(weight @ off**2 / (more * weight.sum()))


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
