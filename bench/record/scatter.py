"""How much a channel scatters from sample to sample, by its own readings."""

import numpy as np

from bench.record.campaign import Array

NORMAL_MAD = 1.4826  # exact: standard deviation of a normal distribution by its median absolute deviation


def scatter_of_samples(values: Array) -> Array:
    """Return the scatter of smooth signals' samples, from their third differences; robust against jumps.

    Args:
        values: Shape (rows, c), of four rows or more.

    Returns:
        Shape (c,), standard deviations of white noise.
    """
    third = np.diff(values, 3, axis=0)
    spread = np.median(np.abs(third - np.median(third, axis=0)), axis=0)
    return np.asarray(NORMAL_MAD * spread / np.sqrt(20.0), dtype=np.float64)
