"""Links that cross the gaps of their gears and bounce there, against one link that is integrated in time."""

from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bench.diagnose.replay.crossing import FINE, Gears, crossing_of
from bench.record.campaign import Array

GAP, INERTIA, STIFFNESS, DAMPING = 3e-4, 285.0, 5.6e5, 1300.0  # of joint 1 of an HH-150
STEP = 0.08  # [s]


def gears(inertia: float = INERTIA, damping: float = 0.0, gap: float = GAP) -> Gears:
    return Gears(*(np.array([value]) for value in (inertia, STIFFNESS, damping, gap)))


class Truth(NamedTuple):
    """A link between two elastic flanks in time.

    Attributes:
        place: Shape (T,), mean around each instant: from -1 to 1, the flanks; torsion beyond them taken off.
        lands: [s], when it first touches the other flank.
        speed: [rad/s], with which it does.
    """

    place: Array
    lands: float
    speed: float


def in_time(torque: Array, time: Array, damping: float) -> Truth:
    """Integrate I x'' = T(t) - k dead(x) - d x', T linear from instant to instant, from rest at the first flank."""
    side = np.sign(torque[0])

    def derivatives(t: float, state: Array) -> list[float]:
        x, speed = state
        held = STIFFNESS * (x - np.clip(x, -GAP / 2, GAP / 2))
        return [speed, (np.interp(t, time, torque) - held - damping * speed) / INERTIA]

    fine = (time[0] - STEP / 2) + STEP * (np.arange(100 * len(time)) + 0.5) / 100
    start = [side * (GAP / 2 + abs(torque[0]) / STIFFNESS), 0.0]
    found = solve_ivp(derivatives, (fine[0], fine[-1]), start, t_eval=fine, max_step=1e-3, rtol=1e-9, atol=1e-12)
    landed = int(np.argmax(found.y[0] * side < -GAP / 2))
    place = np.clip(found.y[0] / (GAP / 2), -1, 1).reshape(len(time), -1).mean(axis=1)
    return Truth(place, float(fine[landed]), abs(float(found.y[1][landed])))


def ramp(slope: float, length: int = 40) -> tuple[Array, Array]:
    """Return a torque with a constant slope [Nm/s] that changes sign in the middle, and its times."""
    time = STEP * np.arange(length)
    return slope * (time[length // 2] + 0.3 * STEP - time), time


@pytest.mark.parametrize("damping", [0.0, DAMPING])
@pytest.mark.parametrize("slope", [5.0, 16.0, 100.0, 600.0])
def test_a_link_crosses_as_it_does_in_time(slope: float, damping: float) -> None:
    torque, time = ramp(slope)
    found, truth = crossing_of(torque[:, None], time, gears(damping=damping)), in_time(torque, time, damping)
    lands = time[np.flatnonzero(found.landing[:, 0])[0]]
    assert abs(lands - truth.lands) < 0.75 * STEP  # around that instant
    assert found.landing.max() == pytest.approx(truth.speed, rel=0.1)
    until = time < truth.lands - STEP / 2  # from then on it bounces
    np.testing.assert_allclose(found.places[until, 0], truth.place[until], atol=0.08)
    np.testing.assert_allclose(found.places[time > truth.lands + STEP, 0], -1.0)


def test_without_damping_a_link_lands_as_fast_as_its_inertia_asks() -> None:
    slope = 16.0
    torque, time = ramp(slope)
    takes = next(t.real for t in np.roots([slope / (6 * INERTIA), 0, slope / STIFFNESS, -GAP]) if t.imag == 0)
    assert 0.3 < takes < 1 / 3
    found = crossing_of(torque[:, None], time, gears()).landing.max()
    assert found == pytest.approx(slope * takes**2 / (2 * INERTIA) + slope / STIFFNESS, rel=0.05)


def test_a_link_that_weighs_nothing_is_at_the_flank_that_it_is_pushed_to() -> None:
    """A torque of 4, 2, 1, -3 Nm, linear in time, changes its sign three quarters through the third interval."""
    torque = np.array([4.0, 2.0, 1.0, -3.0])
    found = crossing_of(torque[:, None], np.arange(4.0), gears(inertia=1e-6)).places[:, 0]
    # third interval: from 1.5 over 1 to -1; fourth: from -1 to -3
    np.testing.assert_allclose(found, [1.0, 1.0, 0.5, -1.0], atol=3 / FINE)


def test_a_short_push_does_not_take_a_link_across() -> None:
    torque = np.array([5.0] * 10 + [-2.0] + [5.0] * 10)
    time = STEP * np.arange(len(torque))
    found = crossing_of(torque[:, None], time, gears())
    assert np.all(found.places > 0.5)
    assert np.any(found.places < 1)
    assert np.count_nonzero(found.landing) == 1  # on the flank that it left
    np.testing.assert_allclose(found.places[-5:], 1.0)


def test_what_was_left_out_between_two_instants_ends_a_flight() -> None:
    torque, time = ramp(5.0)
    paused = time + 10.0 * (np.arange(len(time)) > len(time) // 2)
    found = crossing_of(torque[:, None], paused, gears()).places[:, 0]
    np.testing.assert_allclose(found[len(time) // 2 + 1 :], -1.0)


def test_without_a_gap_nothing_crosses() -> None:
    torque, time = ramp(16.0)
    found = crossing_of(torque[:, None], time, gears(gap=0.0))
    np.testing.assert_allclose(found.places[:, 0], np.where(torque < 0, -1.0, 1.0))
    np.testing.assert_allclose(found.landing, 0.0)
