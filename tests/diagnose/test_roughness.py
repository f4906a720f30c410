"""Where the residual of a motion is rough, stretch by stretch."""

import numpy as np

from bench.diagnose.linearise.roughness import WINDOW, with_roughness


def test_an_instant_that_is_not_compared_parts_a_run_and_hides_nothing() -> None:
    """One bin in which a drive turned round switched the noise of what rings off for its whole run."""
    rng = np.random.default_rng(1)
    left = np.stack([rng.standard_normal(60), rng.standard_normal(60)], axis=1)
    left[:30, 0] *= 20.0
    left[40, 0] = np.nan
    whole = with_roughness(left[:40], np.ones((40, 2)))
    parted = with_roughness(left, np.ones((60, 2)))
    assert np.all(parted[: 30 - WINDOW, 0] > 5.0)
    np.testing.assert_array_equal(parted[:40, 0], whole[:, 0])
    assert np.all(parted[40 + WINDOW :, 0] == 1.0)


def test_stretches_too_short_for_second_differences_stay_as_they_are() -> None:
    left = np.full((9, 1), 50.0)
    left[2::3] = np.nan
    left[0] = -50.0
    np.testing.assert_array_equal(with_roughness(left, np.ones((9, 1))), 1.0)
