"""The filter of model and data: which motion it is made for, and how exact derivatives are behind it."""

import numpy as np

from bench.identify.dynamics.band import band_of, derivative
from bench.identify.dynamics.first_pass import first_pass
from bench.identify.dynamics.quantities import quantities
from bench.identify.dynamics.samples import MotionSamples
from tests.identify.dynamics.rigid_world import Friction, N, arm, recorded, robot

RATE, STEP = 100.0, 1e-4  # [Hz], [rad] of an encoder


def samples_of(position: np.ndarray) -> MotionSamples:
    count = len(position)
    nothing = np.full(position.shape, np.nan)
    return MotionSamples(
        "run", "", RATE, np.arange(count) / RATE, position, nothing, nothing, np.zeros((count, 6)), np.zeros(count)
    )


def test_steps_of_an_encoder_are_no_motion() -> None:
    """A joint that moves by 8 mrad in steps of 0.1 mrad moves as slowly as the one that moves by a radian."""
    time = np.arange(0, 20, 1 / RATE)
    swing = np.sin(2 * np.pi * 0.2 * time) + 0.3 * np.sin(2 * np.pi * 0.5 * time)
    motion = np.stack([swing, 4e-3 * swing], axis=1)
    exact, read = band_of([samples_of(motion)]), band_of([samples_of(np.round(motion / STEP) * STEP)])
    np.testing.assert_allclose(read.bandwidth_hz, exact.bandwidth_hz, atol=0.1)  # [Hz], two steps of the spectrum


def test_derivatives_are_those_of_cubic_splines() -> None:
    """Of a sine: by x = omega h, 3 sin x / (x (2 + cos x)) of the slope, where central differences have sin x / x."""
    for frequency in (5.0, 25.0):
        time, x = np.arange(400) / RATE, 2 * np.pi * frequency / RATE
        slope = derivative(np.sin(2 * np.pi * frequency * time + 0.4)[:, None], RATE)[100:300, 0]
        share = 3 * np.sin(x) / (x * (2 + np.cos(x)))
        exact = 2 * np.pi * frequency * np.cos(2 * np.pi * frequency * time + 0.4)[100:300]
        np.testing.assert_allclose(slope, share * exact, atol=1e-6 * 2 * np.pi * frequency)


def test_a_log_at_twenty_times_the_motions_bandwidth_biases_no_inertia() -> None:
    """Central differences would make inertias 3 % too large: sin(x)^2 / x^2 at 0.5 Hz and 10 samples a second."""
    nominal, none = robot(arm(), mass=0.3), Friction(*np.zeros((3, N)))
    found = first_pass(recorded(nominal, none, np.random.default_rng(3), sigma=1e-3, rate=10.0), nominal, None, False)
    inertia = {one.name: one for one in quantities(found) if one.kind == "inertia"}
    for name in ("Izz 1 (base)", "rotor 3 (elbow)"):
        assert abs(inertia[name].value / inertia[name].nominal - 1) < 3e-3, name
