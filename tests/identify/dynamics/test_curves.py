"""Splines that are read all at once, against each one read by itself."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from bench.identify.dynamics.curves import Curves


@pytest.mark.parametrize("delay", [0.0, 0.013, -0.02, 5.0, -5.0])
def test_each_row_reads_its_own_spline_also_beyond_its_ends(delay: float) -> None:
    rng = np.random.default_rng(2)
    knots = [np.linspace(3.0, 4.0, 50), np.sort(rng.uniform(-1.0, 0.5, 30)), np.linspace(3.5, 9.0, 80)]
    splines = [CubicSpline(own, rng.standard_normal(len(own))) for own in knots]
    times = [np.append(rng.uniform(own[0] - 0.01, own[-1] + 0.01, 7), own[[0, 3, -1]]) for own in knots]
    times[1] = times[1][:0]  # of which no row is used
    alone = np.concatenate([spline(time + delay) for spline, time in zip(splines, times, strict=True)])
    np.testing.assert_allclose(Curves.of(splines, times).at(delay), alone, rtol=1e-9, atol=1e-9)
