"""Gears wind up along a motion: replays against simulations in time, and the splines that tell how fast."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.winding import MotionSpline
from bench.diagnose.replay.world import NOMINAL
from bench.record.campaign import Array, Campaign
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.diagnose.noise_free import linearised, noise_free
from tests.diagnose.small_models import chi_square_left
from tests.elastic_arm import elastic


def test_a_soft_arm_is_repeated_as_it_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    """Drives 1 to 3 were missed by 8.0, 5.5 and 1.2 Nm of 3 kNm, with products of inertia and acceleration besides."""
    compiled = compile_robot(load_robot("kr300"))
    run = elastic(compiled, 10.0)
    quantities = quantities_of((run,), compiled)
    segments = segments_of(Campaign("kr300", (run,)), compiled, quantities)

    def left() -> Array:
        """Return the root mean square of what is missed of each torque, shape (6,) [Nm]."""
        missed = segments[0].observed - Replay(compiled, segments, quantities).predict(NOMINAL)
        return np.sqrt(np.nanmean(missed**2, axis=0))

    wound = left()
    monkeypatch.setattr(MotionSpline, "rates", lambda _, winding: np.zeros((2, *winding.shape)))
    stiff = left()
    print("missed [Nm]:", stiff.round(2), "with links as their motors,", wound.round(2), "with gears that wind up")
    assert np.all(stiff[:2] > 5)
    assert np.all(wound[:2] < stiff[:2] / 5)
    assert np.all(wound[:3] < (1.5, 0.5, 0.2))
    assert np.all(wound < 1.02 * stiff)


def test_a_lab_s_day_leaves_less(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a sound HH-150, read without noise."""
    campaign, left = noise_free("session-study"), []
    for rates in (MotionSpline.rates, lambda _, winding: np.zeros((2, *winding.shape))):
        monkeypatch.setattr(MotionSpline, "rates", rates)
        linear = linearised(campaign)
        left.append(chi_square_left(linear, linear.white))
    print(f"chi-square that figures leave: {left[1]:.0f}, and {left[0]:.0f} with gears that wind up")
    assert left[0] < left[1]


def test_splines_are_scipy_s_motion_by_motion(rng: np.random.Generator) -> None:
    """Uneven bins, a rest, and a motion with bins left out; the approach and the rest belong to none."""
    once = np.concatenate([[-1.0], np.cumsum(rng.uniform(0.9, 1.1, 12))])
    interrupted = np.concatenate([[3.0], 5.0 + np.arange(6), 20.0 + np.arange(7)])
    segments: Any = [
        SimpleNamespace(is_static=rests, motion=SimpleNamespace(time=time))
        for rests, time in ((False, once), (True, np.arange(4.0)), (False, interrupted))
    ]
    values = rng.standard_normal((13 + 4 + 14, 3))
    first, second = MotionSpline.through(segments).rates(values)
    told = np.zeros(len(values), dtype=bool)
    for rows, time in (
        (np.arange(1, 13), once[1:]),
        (17 + np.arange(1, 7), interrupted[1:7]),
        (17 + np.arange(7, 14), interrupted[7:]),
    ):
        spline = CubicSpline(time, values[rows], bc_type="natural")
        np.testing.assert_allclose(first[rows], spline(time, 1), atol=1e-12)
        expected = np.zeros_like(values[rows])
        bent = spline(time, 2)
        expected[1:-1] = (bent[:-2] + 10 * bent[1:-1] + bent[2:]) / 12
        np.testing.assert_allclose(second[rows], expected, atol=1e-12)
        told[rows] = True
    assert not np.any(first[~told])
    assert not np.any(second[~told])


@pytest.mark.parametrize(("bins", "most"), [(4, 0.02), (8, 2e-3)])
def test_second_derivatives_of_a_vibration(bins: int, most: float) -> None:
    """By so many bins to a period; those of a cubic spline alone are 22 and 5 % too large."""
    time = np.arange(-1.0, 20 * bins)
    segments: Any = [SimpleNamespace(is_static=False, motion=SimpleNamespace(time=time))]
    wave = np.sin(2 * np.pi / bins * time + 0.3)[:, None]
    _, second = MotionSpline.through(segments).rates(wave)
    middle = slice(5 * bins, 15 * bins)
    np.testing.assert_allclose(
        second[middle], -((2 * np.pi / bins) ** 2) * wave[middle], atol=most * (2 * np.pi / bins) ** 2
    )
