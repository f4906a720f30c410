"""Effects of sensing: arithmetic on readings."""

from dataclasses import replace

import numpy as np
import pytest

from bench.effects.conditions import Conditions
from bench.robot.compiled import CompiledRobot
from bench.robot.folder import Robot
from bench.simulate.instruments import Reading
from bench.simulate.trace import Trace
from tests.effects.rest import CATALOGUE, perfect_reading, some_trace

EXACT = 1e-12


@pytest.fixture(scope="module")
def seen(small: Robot) -> tuple[CompiledRobot, Trace, Reading]:
    plant, trace = some_trace(small, np.random.default_rng(0))
    return plant.compiled, trace, perfect_reading(plant.compiled, trace)


def distorted(
    name: str,
    seen: tuple[CompiledRobot, Trace, Reading],
    values: dict[str, float],
    conditions: Conditions | None = None,
) -> tuple[Reading, Reading, Trace]:
    compiled, trace, reading = seen
    effect = CATALOGUE[name]
    place = effect.places(compiled)[-1]
    conditions = conditions or Conditions.reference(2)
    return effect.distort(place, effect.complete(values), reading, trace, conditions), reading, trace


def check_second_current(after: Reading, before: Reading, expected: np.ndarray) -> None:
    np.testing.assert_allclose(after.current[:, 1], expected, rtol=EXACT)
    np.testing.assert_array_equal(after.current[:, 0], before.current[:, 0])


def test_torque_constant(seen: tuple) -> None:
    after, before, trace = distorted("torque_constant", seen, {"change": 0.1})
    check_second_current(after, before, trace.motor_torque[:, 1] / (1.1 * 100))


def test_torque_constant_changes_a_reported_torque_too(seen: tuple) -> None:
    compiled, trace, reading = seen
    torque = replace(reading, torque=trace.motor_torque)
    after, _, _ = distorted("torque_constant", (compiled, trace, torque), {"change": 0.1})
    np.testing.assert_allclose(after.torque[:, 1], trace.motor_torque[:, 1] / 1.1, rtol=EXACT)


def test_saturation(seen: tuple) -> None:
    after, before, _ = distorted("torque_saturation", seen, {"curvature": 1e-3})
    current = before.current[:, 1]
    check_second_current(after, before, current * (1 + 1e-3 * current**2))


def test_winding_temperature(seen: tuple) -> None:
    conditions = Conditions(np.full(2, 293.15), np.array([293.15, 353.15]))
    after, before, _ = distorted("torque_constant_temperature", seen, {"decrease": 1e-3}, conditions)
    check_second_current(after, before, before.current[:, 1] / 0.94)


def test_current_offset(seen: tuple) -> None:
    after, before, _ = distorted("current_offset", seen, {"offset": -0.2})
    check_second_current(after, before, before.current[:, 1] - 0.2)


def test_tracker_frame(seen: tuple) -> None:
    after, before, _ = distorted("tracker_frame", seen, {"tx": 1e-4, "rz": 1e-3})
    p = before.reflectors
    expected = p + np.stack([1e-4 - 1e-3 * p[..., 1], 1e-3 * p[..., 0], 0 * p[..., 2]], axis=-1)
    np.testing.assert_allclose(after.reflectors, expected, atol=EXACT)


def test_tracker_drift(seen: tuple) -> None:
    """The trace begins an hour after the campaign did."""
    after, before, _ = distorted("tracker_drift", seen, {"y": 2e-5})
    np.testing.assert_allclose((after.reflectors - before.reflectors)[0], np.tile([0, 2e-5, 0], (3, 1)), atol=EXACT)


def test_tracker_scale(seen: tuple) -> None:
    after, before, _ = distorted("tracker_scale", seen, {"scale": 3e-4})
    np.testing.assert_allclose(after.reflectors, before.reflectors * (1 + 3e-4), rtol=EXACT)


def test_force_gain(seen: tuple) -> None:
    after, _, trace = distorted("force_gain", seen, {"gain": 0.02})
    np.testing.assert_allclose(np.hstack([after.force, after.moment]), 1.02 * trace.wrench, rtol=EXACT)


def test_force_tilt(seen: tuple) -> None:
    """A slanting load is turned, a hanging one counts as vertical."""
    compiled, trace, _ = seen
    after, before, _ = distorted("force_tilt", seen, {"x": 0.02})
    f = before.force
    np.testing.assert_allclose(
        after.force, np.stack([f[:, 0], f[:, 1] - 0.02 * f[:, 2], f[:, 2] + 0.02 * f[:, 1]], axis=1), atol=1e-9
    )
    hanging = replace(trace, wrench=trace.wrench * [0, 0, 1, 0, 0, 0])
    reading = perfect_reading(compiled, hanging)
    after, _, _ = distorted("force_tilt", (compiled, hanging, reading), {"x": 0.02})
    np.testing.assert_array_equal(after.force, reading.force)


def test_encoders(seen: tuple) -> None:
    compiled, trace, _ = seen
    delay, eccentric = CATALOGUE["encoder_delay"], CATALOGUE["encoder_eccentricity"]
    late = delay.encoder_error(delay.places(compiled)[0], {"delay": 3e-3}, trace.q, trace.q_velocity)
    np.testing.assert_allclose(late, -3e-3 * trace.q_velocity)
    place = eccentric.places(compiled)[1]
    error = eccentric.encoder_error(place, {"sin": 1e-4, "cos": 2e-4}, trace.q, trace.q_velocity)
    assert error is not None
    np.testing.assert_array_equal(error[:, 0], 0)
    np.testing.assert_allclose(error[:, 1], 1e-4 * np.sin(trace.q[:, 1]) + 2e-4 * np.cos(trace.q[:, 1]))


def test_a_missing_instrument_has_no_effects(seen: tuple) -> None:
    compiled = seen[0]
    figures = compiled.robot.figures
    bare = figures.instruments.model_copy(update={"tracker": None, "force": None, "current": None})
    robot = replace(compiled.robot, figures=figures.model_copy(update={"instruments": bare}))
    without = replace(compiled, robot=robot)
    for name in ("tracker_frame", "force_gain", "current_offset", "torque_constant"):
        assert not CATALOGUE[name].places(without)
