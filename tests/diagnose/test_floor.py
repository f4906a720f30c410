"""What a right model is expected to leave of a reading."""

import numpy as np

from bench.diagnose.cross_validation.floor import floor_variance
from bench.diagnose.replay.noise import UNIFORM
from tests.diagnose.small_models import linear_of
from tests.diagnose.sweeps import SWEEPS, made, nominal


def test_a_gauge_that_shows_one_digit_all_day_is_no_worse_for_that() -> None:
    """Its readings count as one in a fit; their floor was ten steps, and models went below it."""
    linear = linear_of(made(SWEEPS, seed=5))
    names = [quantity.column for quantity in linear.quantities]
    floor = np.sqrt(floor_variance(linear)[:, names.index("gas_pressure_pa")])
    gauge = nominal().robot.figures.instruments.pressure
    assert gauge
    stated = gauge.resolution_pa * UNIFORM
    assert np.nanmedian(floor) < 1.01 * stated  # more only where the readings of an instant differ
    assert np.nanmax(floor) < 1.5 * stated
    counted = np.concatenate([segment.counted_once for segment in linear.weighed if segment.counted_once is not None])
    assert np.sqrt(counted[:, names.index("gas_pressure_pa")].max()) > 2 * stated
