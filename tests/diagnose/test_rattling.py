"""How high links bounce in gears with play, against one link that is integrated in time."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bench.diagnose.linearise.rattling import flight_height, ringing
from bench.diagnose.replay.motion_segments import DAMPING_RATIO
from bench.record.campaign import Array

INERTIA, STIFFNESS = 285.0, 5.6e5  # of joint 1 of an HH-150
SWING = np.sqrt(INERTIA / STIFFNESS)


@pytest.mark.parametrize(("rings", "push"), [(30.0, 10.0), (80.0, 10.0), (80.0, 60.0)])
def test_a_link_that_rings_flies_off_as_far_as_its_energy_takes_it(rings: float, push: float) -> None:
    """I x'' = -P - k x where x < 0, its flank at 0; it begins where it is pressed by P + A."""

    def derivatives(t: float, state: Array) -> list[float]:
        return [state[1], (-push - STIFFNESS * min(state[0], 0.0)) / INERTIA]

    start = [-(push + rings) / STIFFNESS, 0.0]
    flown = solve_ivp(derivatives, (0.0, 2.0), start, max_step=1e-3, rtol=1e-9, atol=1e-13).y[0].max()
    found = flight_height(np.array(rings), np.array(push), np.array(STIFFNESS))
    assert found == pytest.approx(flown, rel=1e-3)


def test_a_link_that_rings_by_less_than_it_is_pushed_stays() -> None:
    assert flight_height(np.array(30.0), np.array(30.0), np.array(STIFFNESS)) == 0
    assert flight_height(np.array(0.0), np.array(0.0), np.array(STIFFNESS)) == 0


def test_a_torque_that_stops_growing_leaves_a_link_ringing() -> None:
    """I x'' = T(t) - k x - d x', from where it follows a ramp."""
    slope, step = 2000.0, 0.08
    time = step * np.arange(12)
    torque = slope * np.minimum(time, time[5])
    damping = 2 * DAMPING_RATIO * np.sqrt(STIFFNESS * INERTIA)

    def derivatives(t: float, state: Array) -> list[float]:
        pull = np.interp(t, time, torque) - STIFFNESS * state[0] - damping * state[1]
        return [state[1], pull / INERTIA]

    fine = np.arange(0.0, time[-1], 1e-3)
    follows = [-slope * damping / STIFFNESS**2, slope / STIFFNESS]
    angle = solve_ivp(derivatives, (0.0, time[-1]), follows, t_eval=fine, max_step=1e-3, rtol=1e-8, atol=1e-12).y[0]
    left = np.abs(STIFFNESS * angle - np.interp(fine, time, torque))
    swing = np.full((len(time), 1), SWING)
    found = ringing(torque[:, None], time, np.zeros((len(time), 1)), swing)[:, 0]
    np.testing.assert_allclose(found[:5], 0.0, atol=1e-9)
    for i in range(5, len(time) - 2):  # largest over a period from there on
        soon = (fine >= time[i]) & (fine < time[i] + 2 * np.pi * SWING)
        assert found[i] == pytest.approx(left[soon].max(), rel=0.15)


def test_a_landing_rings_until_it_fades() -> None:
    time = 0.08 * np.arange(10)
    struck = np.zeros((10, 1))
    struck[3] = 50.0
    found = ringing(np.zeros((10, 1)), time, struck, np.full((10, 1), SWING))[:, 0]
    np.testing.assert_allclose(found[:3], 0.0)
    np.testing.assert_allclose(found[3:], 50 * np.exp(-DAMPING_RATIO * (time[3:] - time[3]) / SWING))


def test_a_link_that_nothing_holds_flies_as_far_as_it_may() -> None:
    """A stranger's slide whose torque passes through zero while it rings: "overflow encountered in divide"."""
    assert flight_height(np.array([1e3]), np.array([0.0]), np.array([1e-9])) == np.inf
