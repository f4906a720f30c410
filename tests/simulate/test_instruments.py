"""What the instruments make of a known truth: spread, resolution, and which errors stay."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from bench.record.units import HOUR
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.simulate.instruments import Instruments, small_rotation
from bench.simulate.trace import Trace

READINGS = 4000
SPREAD = 0.06  # relative; the standard deviation of 4000 normal readings is known to 1.1 %, five times that


@pytest.fixture(scope="module")
def compiled(small_robot: Path) -> CompiledRobot:
    return compile_robot(load_robot(small_robot))


def standing(count: int, wrench: tuple[float, ...] = (0, 0, -100, 0, 0, 0), seconds: float = 0.0) -> Trace:
    """Return a robot that does not move, looked at `count` times over `seconds`."""

    def same(values: object) -> np.ndarray:
        return np.repeat(np.array(values, dtype=float)[None], count, axis=0)

    nests = [[0.7, 0.1, 1.0], [0.7, -0.2, 0.8], [0.5, 0.1, 0.8]]
    return Trace(
        time=np.linspace(0, seconds, count),
        q=same([0.3, 0.2]),
        q_velocity=same([0, 0]),
        theta=same([0.31, 0.21]),
        theta_velocity=same([0, 0]),
        motor_torque=same([250.0, -75.0]),
        motor_friction=same([0, 0]),
        link_friction=same([0, 0]),
        reflectors=same(nests),
        load_point=same([0.7, 0, 0.8]),
        wrench=same(wrench),
        counterbalance_force=np.full(count, 3456.7),
        gas_force=np.full(count, 3456.7),
        counterbalance_length=np.full(count, 0.4),
    )


def axes_of_nests(compiled: CompiledRobot, theta: np.ndarray) -> list[np.ndarray]:
    """Return the axes of the body that carries each reflector: what sits off in a nest turns with it."""
    data = mujoco.MjData(compiled.model)
    data.qpos[compiled.at.theta] = theta
    mujoco.mj_kinematics(compiled.model, data)
    return [data.xmat[compiled.model.site_bodyid[site]].reshape(3, 3) for site in compiled.at.reflectors]


def test_spread_of_repeats_is_that_of_the_figures(compiled: CompiledRobot) -> None:
    figures = compiled.robot.figures.instruments
    assert figures.current
    assert figures.force
    assert figures.tracker
    seen = Instruments(compiled, np.random.default_rng(1)).read(standing(READINGS))
    rounding = figures.current.resolution_a / np.sqrt(12)
    np.testing.assert_allclose(seen.current.std(axis=0), np.hypot(figures.current.sigma_a, rounding), rtol=SPREAD)
    np.testing.assert_allclose(seen.force.std(axis=0), figures.force.sigma_n, rtol=SPREAD)
    np.testing.assert_allclose(seen.moment.std(axis=0), figures.force.sigma_nm, rtol=SPREAD)
    distance = np.linalg.norm(standing(1).reflectors[0] - np.array(figures.tracker.position_m), axis=1)
    expected = figures.tracker.sigma_per_distance * distance[:, None]
    np.testing.assert_allclose(seen.reflectors.std(axis=0), expected * np.ones(3), rtol=SPREAD)


def test_errors_that_stay_are_those_of_the_draw(compiled: CompiledRobot) -> None:
    """Means over many readings differ from the truth by gain, offset, frame and placement, and by nothing else."""
    instruments = Instruments(compiled, np.random.default_rng(2))
    trace, errors = standing(READINGS, (30, 0, -100, 0, 0, 0)), instruments.errors
    seen = instruments.read(trace)
    current = trace.motor_torque[0] / compiled.torque_constant * (1 + errors.current_gain) + errors.current_offset
    np.testing.assert_allclose(seen.current.mean(axis=0), current, atol=5 * 0.02 / np.sqrt(READINGS))
    force = small_rotation(errors.force_tilt) @ trace.wrench[0, :3] * (1 + errors.force_gain)
    np.testing.assert_allclose(seen.force.mean(axis=0), force, atol=5 * 0.5 / np.sqrt(READINGS))
    axes = axes_of_nests(compiled, trace.theta[0])
    nests = np.stack([own @ at for own, at in zip(axes, errors.placement, strict=True)])
    places = (trace.reflectors[0] + nests) @ small_rotation(errors.frame_rotation).T + errors.frame_shift
    np.testing.assert_allclose(seen.reflectors.mean(axis=0), places, atol=5 * 30e-6 / np.sqrt(READINGS))


def test_draws_spread_as_the_figures_say(compiled: CompiledRobot) -> None:
    figures = compiled.robot.figures
    assert figures.instruments.current
    draws = [Instruments(compiled, np.random.default_rng(seed)).errors for seed in range(READINGS)]
    gain = np.hypot(figures.instruments.current.gain_sigma, figures.drives[0].torque_constant_error)
    np.testing.assert_allclose(np.std([draw.current_gain for draw in draws], axis=0), gain, rtol=SPREAD)
    assert figures.instruments.force
    np.testing.assert_allclose(np.std([draw.force_gain for draw in draws]), 0.005, rtol=SPREAD)
    np.testing.assert_allclose([np.linalg.norm(draw.drift_direction) for draw in draws], 1)


def test_direction_of_a_hanging_load_is_not_measured(compiled: CompiledRobot) -> None:
    instruments = Instruments(compiled, np.random.default_rng(3))
    hanging = instruments.read(standing(READINGS)).force.mean(axis=0)
    np.testing.assert_allclose(hanging[:2], 0, atol=5 * 0.5 / np.sqrt(READINGS))


def test_tracker_drifts_with_time(compiled: CompiledRobot) -> None:
    figures = compiled.robot.figures.instruments.tracker
    assert figures
    instruments = Instruments(compiled, np.random.default_rng(4))
    seen = instruments.read(standing(READINGS, seconds=10 * HOUR)).reflectors
    quarter = READINGS // 4
    moved = seen[-quarter:].mean(axis=(0, 1)) - seen[:quarter].mean(axis=(0, 1))
    expected = 7.5 * figures.drift_m_per_h * instruments.errors.drift_direction
    np.testing.assert_allclose(moved, expected, atol=5 * 30e-6 / np.sqrt(quarter))


def test_gauge_and_current_show_whole_steps(compiled: CompiledRobot) -> None:
    seen = Instruments(compiled, np.random.default_rng(5)).read(standing(50))
    np.testing.assert_allclose(seen.gas_pressure, 35e5)  # 3456.7 N on 10 cm^2 is 34.567 bar, shown in bar
    np.testing.assert_allclose(seen.current / 0.01, np.round(seen.current / 0.01), atol=1e-9)


def test_first_reflector_stays_in_its_nest(compiled: CompiledRobot) -> None:
    instruments = Instruments(compiled, np.random.default_rng(6))
    before = instruments.errors.placement.copy()
    instruments.move_reflector()
    np.testing.assert_array_equal(instruments.errors.placement[0], before[0])
    assert np.all(instruments.errors.placement[1:] != before[1:])
