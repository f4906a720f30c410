"""What two drives that move paid, made by hand."""

import numpy as np

from bench.diagnose.plausibility.drive_picture import DrivePicture
from bench.record.campaign import Array


def picture_of(observed: Array, model: Array, velocity: Array) -> DrivePicture:
    """Return a picture of two drives that move all the time, shape (T, 2) each [Nm], [Nm] and [rad/s]."""
    return DrivePicture(
        observed=observed,
        model=model,
        velocity=velocity,
        standing=np.zeros(observed.shape, dtype=np.bool_),
        slack=np.ones(2),
        level=np.zeros(2),
        spare=np.zeros((2, 2)),
        unit=np.ones(2),
        missing=np.zeros((*observed.shape, 0)),
        names=("current_1_a", "current_2_a"),
    )
