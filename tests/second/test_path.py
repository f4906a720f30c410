"""The second plant's drives along a path, against closed forms."""

from math import exp, tanh

import numpy as np
import pytest

from bench.second.figures import Array, Law
from bench.second.path import Element, Spring, dahl, held, link_path, motor_path

K, SIGMA, LEVEL = 2e6, 1e6, 100.0


def element(n: int, drawn: Array | None = None) -> Element:
    return Element(
        np.full(n, SIGMA), np.full(n, LEVEL), np.full(n, LEVEL), np.full(n, np.nan) if drawn is None else drawn
    )


def first(n: int) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    return np.arange(n) == 0


@pytest.mark.parametrize("steps", [1, 7])
def test_dahl_is_exact_over_any_step(steps: int) -> None:
    force = 40.0
    for _ in range(steps):
        force = dahl(force, 2e-4 / steps, SIGMA, LEVEL, 50.0)
    assert force == pytest.approx(-LEVEL + 140.0 * exp(-SIGMA * 2e-4 / LEVEL), rel=1e-12)


def test_return_map_slips_at_either_level() -> None:
    assert held(0.0, 1.0, SIGMA, LEVEL, 50.0) == -LEVEL
    assert held(0.0, -1.0, SIGMA, LEVEL, 50.0) == 50.0
    assert held(10.0, 1e-5, SIGMA, LEVEL, 50.0) == pytest.approx(0.0)


@pytest.mark.parametrize("torque", [-3000.0, -20.0, 0.0, 20.0, 3000.0])
def test_bent_spring_with_play_gives_back_its_torque(torque: float) -> None:
    spring = Spring(K, 0.6, 400.0, 2e-4)
    x = spring.torsion(torque)
    assert spring.torque(x) == pytest.approx(torque, abs=1e-5)
    if torque > 0:
        beyond = x - 1e-4
        assert torque == pytest.approx(K * beyond - 0.6 * 400.0 * tanh(K * beyond / 400.0), rel=1e-6)


@pytest.mark.parametrize("law", ["elasto-plastic", "dahl"])
@pytest.mark.parametrize("spring", [Spring(K, 0.0, 1.0, 0.0), Spring(K, 0.5, 300.0, 0.0), Spring(K, 0.0, 1.0, 1e-4)])
def test_links_rest_in_balance(spring: Spring, law: Law) -> None:
    """Along any path spring and friction give what is asked for, and friction stays between its levels."""
    rng = np.random.default_rng(3)
    q, asked = np.cumsum(1e-4 * rng.standard_normal(60)), 500 * np.sin(np.arange(60) / 5)
    theta, friction = link_path(spring, q, asked, [element(60)], first(60), law)
    given = np.array([spring.torque(x) for x in q - theta]) + friction[:, 0]
    assert given == pytest.approx(asked, abs=2e-6)
    assert np.max(np.abs(friction)) <= LEVEL * (1 + 1e-12)
    assert np.ptp(friction) > LEVEL


def test_bisection_finds_what_the_closed_form_does() -> None:
    rng = np.random.default_rng(4)
    q, asked = np.cumsum(1e-4 * rng.standard_normal(60)), 500 * np.sin(np.arange(60) / 5)
    plain = link_path(Spring(K, 0.0, 1.0, 0.0), q, asked, [element(60)], first(60), "elasto-plastic")[0]
    half = Element(np.full(60, SIGMA / 2), np.full(60, LEVEL / 2), np.full(60, LEVEL / 2), np.full(60, np.nan))
    twice = link_path(Spring(K, 0.0, 1.0, 0.0), q, asked, [half, half], first(60), "elasto-plastic")[0]
    assert twice == pytest.approx(plain, abs=1e-12)


def test_newton_finds_what_bisection_does() -> None:
    """Dahl's law on a plain spring, and on one with a play too small to matter."""
    rng = np.random.default_rng(5)
    q, asked = np.cumsum(1e-4 * rng.standard_normal(60)), 500 * np.sin(np.arange(60) / 5)
    plain, almost = (
        link_path(Spring(K, 0.0, 1.0, gap), q, asked, [element(60)], first(60), "dahl")[0] for gap in (0.0, 1e-15)
    )
    assert almost == pytest.approx(plain, abs=1e-12)


def test_links_rest_where_friction_leaves_them() -> None:
    drawn = np.full(3, np.nan)
    drawn[1] = 0.5
    spring = Spring(K, 0.0, 1.0, 0.0)
    theta, friction = link_path(spring, np.ones(3), np.full(3, 300.0), [element(3, drawn)], first(3), "elasto-plastic")
    assert friction[:, 0] == pytest.approx([0.0, -0.5 * LEVEL, -0.5 * LEVEL])
    assert theta == pytest.approx(1 - np.array([300.0, 350.0, 350.0]) / K, abs=1e-14)


def test_servos_give_by_torque_and_take_it_back() -> None:
    kp, n = 1e7, 4
    none = Element(np.full(n, SIGMA), np.zeros(n), np.zeros(n), np.full(n, np.nan))
    needed = np.array([0.0, 1000.0, 1000.0, 1000.0])
    stiff, _ = motor_path(np.ones(n), needed, none, kp, np.ones(n), first(n), "elasto-plastic")
    assert stiff == pytest.approx([1, 1 - 1e-4, 1 - 1e-4, 1 - 1e-4], abs=1e-14)
    left = np.full(n, exp(-1))
    taken, _ = motor_path(np.ones(n), needed, none, kp, left, first(n), "elasto-plastic")
    assert taken == pytest.approx(1 - 1e-4 * np.array([0, exp(-1), exp(-2), exp(-3)]), abs=1e-14)


def test_friction_of_a_motor_holds_against_its_servo() -> None:
    """A servo of stiffness kp beside friction of stiffness sigma: both share the torque until friction slips."""
    kp, n = 1e7, 2
    for torque, slips in ((50.0, False), (5000.0, True)):
        needed = np.array([0.0, torque])
        q, friction = motor_path(np.zeros(n), needed, element(n), kp, np.ones(n), first(n), "elasto-plastic")
        expected = LEVEL if slips else torque * SIGMA / (kp + SIGMA)
        assert friction[1] == pytest.approx(expected, rel=1e-12)
        assert q[1] == pytest.approx(-(torque - expected) / kp, rel=1e-12)
