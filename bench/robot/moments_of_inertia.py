"""Moments of inertia from second moments of mass, and back: any that are not negative are those of some body."""

import numpy as np

from bench.record.campaign import Array

THIN = 1e-12  # rounding: least second moment of a mass along an axis, as a part of all three


def second_moments(inertia: Array) -> Array:
    """Return the second moments of a mass along its principal axes from its moments of inertia about them.

    Args:
        inertia: Shape (3,) [kg m^2].

    Returns:
        Shape (3,) [kg m^2]: integrals of x^2 dm, y^2 dm and z^2 dm.
    """
    return np.asarray(np.maximum(np.sum(inertia) / 2 - inertia, 0.0))


def moments_of_inertia(second: Array) -> Array:
    """Return the moments of inertia about three axes from the second moments of a mass along them, shape (3,) [kg m^2].

    One of a plate is as large as the other two together. It is kept below that by more than rounding, for the engine
    compiles no model with a larger one.
    """
    total = np.sum(second)
    return np.asarray(total - np.maximum(second, THIN * total))
