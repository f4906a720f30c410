"""The engine plugin against its NumPy twin, over random parameters and random paths."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.actuators.laws import Friction, GasSpring, TorqueTable
from tests.actuators.slider import TIMESTEP, Array, follow, slider

AGREEMENT = 1e-9  # relative to the largest force, or 1 N: the same formulas in the same order, only rounding is left
STEPS = 60

reproducible = settings(derandomize=True, max_examples=60)
unit = st.integers(0, 1000).map(lambda thousandths: thousandths / 1000)
seeds = st.integers(0, 2**32 - 1)


def assert_agree(plugin: Array, twin: Array) -> None:
    np.testing.assert_allclose(plugin, twin, rtol=0, atol=AGREEMENT * max(1.0, float(np.max(np.abs(twin)))))


def walk(seed: int, start: float, size: float) -> Array:
    """Return a random path: slow creep, jumps and rests."""
    rng = np.random.default_rng(seed)
    strides = rng.normal(size=STEPS) * size * rng.choice([0.0, 0.01, 0.1, 1.0], size=STEPS)
    return start + np.cumsum(strides)


@reproducible
@given(seeds, *[unit] * 8)
def test_gas_spring(
    seed: int, c: float, n: float, l_r: float, gas: float, gamma: float, tau: float, s: float, k: float
):
    law = GasSpring(
        constant=1 + 5000 * c,
        critical_length=0.9,
        exponent=1 + 0.6 * n,
        reference_length=0.8 * l_r,
        gas_amount=0.5 + gas,
        heat_capacity_ratio=1 + 0.6 * gamma,
        relaxation_time=10 ** (6 * tau - 4),
        seal_friction=0.1 * s,
        seal_presliding=10 ** (4 + 4 * k),
    )
    length = np.clip(walk(seed, 0.5, 0.1), 0.1, 0.85)
    assert_agree(follow(slider(law), length)[:, 0], law.force(length, TIMESTEP))


@reproducible
@given(seeds, *[unit] * 6, st.tuples(*[unit] * 8))
def test_friction(seed: int, c: float, k: float, r: float, vs: float, a: float, lc: float, more: tuple[float, ...]):
    ripple, phase, rolling, lean, *drag, speed = more
    law = Friction(
        coulomb=400 * c,
        rolling=300 * rolling,
        rolling_asymmetry=1.8 * lean - 0.9,
        drag=200 * drag[0] - 100,
        drag_square=100 * drag[1] - 50,
        drag_cube=20 * drag[2] - 10,
        drag_speed=0.1 + 10 * speed,
        presliding_stiffness=10 ** (4 + 4 * k),
        static_rise=0.5 * r,
        stribeck_velocity=10 ** (2 * vs - 2),
        asymmetry=1.8 * a - 0.9,
        load_coefficient=0.06 * lc,
        element="gear",
        ripple=0.9 * ripple,
        ripple_period=0.1,
        ripple_phase=6 * phase,
    )
    x, w = walk(seed, 0.0, 0.01), walk(seed + 1, 0.0, 0.01)
    v = np.diff(x, append=x[-1:]) / TIMESTEP
    plugin = follow(slider(law, gear='stiffness="1e6"'), x, v, w)[:, 0]
    assert_agree(plugin, law.force(x, v, 1e6 * (x - w)))


@reproducible
@given(seeds, st.integers(2, 40), unit, unit)
def test_torque_table(seed: int, count: int, k: float, width: float):
    rng = np.random.default_rng(seed)
    forward = rng.normal(size=count) * 50
    law = TorqueTable(
        angle_min=-0.1 - width,
        angle_max=0.2 + width,
        forward=tuple(forward.tolist()),
        backward=tuple((forward + 30 * rng.random(count)).tolist()),
        presliding_stiffness=10 ** (3 + 4 * k),
    )
    x = walk(seed, 0.0, 0.5)  # beyond both ends at times
    assert_agree(follow(slider(law), x)[:, 0], law.force(x))


def test_table_of_a_python_law():
    angles = np.linspace(-1, 1, 41)
    law = TorqueTable.of(lambda x: 40 * np.sin(x), -1, 1, angles.size)
    np.testing.assert_allclose(follow(slider(law), angles)[:, 0], 40 * np.sin(angles), atol=1e-12)


def test_long_table():
    law = TorqueTable.of(np.cos, -3, 3, 5000)
    x = np.linspace(-3, 3, 50)
    chord = (6 / 4999) ** 2 / 8  # largest distance between a unit cosine and its chord
    np.testing.assert_allclose(follow(slider(law), x)[:, 0], np.cos(x), atol=chord)


@pytest.mark.parametrize("gear", ['stiffness="1000 200 3000"', 'stiffness="1000" springlength="-0.01 0.02"'])
def test_transmitted_torque_is_that_of_the_native_spring(gear: str, rng: np.random.Generator):
    law = Friction(coulomb=0, presliding_stiffness=1e12, load_coefficient=0.5, element="gear")
    x = np.arange(1, 40)  # one direction, far enough to slide at each step
    w = x + rng.normal(size=x.size) * 0.3
    stretch = x - w
    if "springlength" in gear:
        stretch = np.where(stretch > 0.02, stretch - 0.02, np.where(stretch < -0.01, stretch + 0.01, 0))
        torque = 1000 * stretch
    else:
        torque = stretch * (1000 + stretch * (200 + stretch * 3000))
    np.testing.assert_allclose(follow(slider(law, gear=gear), x, 0, w)[1:, 0], -0.5 * np.abs(torque)[1:], rtol=1e-9)
