"""The robot in time: rest after a reset, interpolated commands, reproducibility, and the trace against the model."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from bench.robot.edits import friction_on, proportional_servo
from bench.robot.folder import load_robot
from bench.simulate.plant import Plant
from bench.simulate.trace import Trace

PERIOD = 4e-3  # [s]
Q = np.array([0.3, 0.2])


@pytest.fixture
def plant(small_robot: Path) -> Plant:
    made = Plant(load_robot(small_robot))
    made.reset(Q)
    return made


def hold(plant: Plant, periods: int, force: float = 0.0) -> Trace:
    return plant.advance(np.tile(Q, (periods, 1)), np.tile([0, 0, force, 0, 0, 0], (periods, 1)), PERIOD)


def test_nothing_moves_after_a_reset(plant: Plant) -> None:
    trace = hold(plant, 250)
    assert np.ptp(trace.theta, axis=0).max() < 1e-12
    assert np.ptp(trace.q, axis=0).max() < 1e-12


def test_servo_returns_to_its_command_under_load(plant: Plant) -> None:
    trace = hold(plant, 2500, -250)
    assert np.abs(trace.q - Q).max() > 1e-4, "a servo gives while the load comes on"
    np.testing.assert_allclose(trace.q[-1], Q, atol=1e-9)


def test_commands_are_interpolated_within_a_period(plant: Plant) -> None:
    """A ramp in steps of one period is followed as smoothly as the same ramp in steps of ten periods."""
    ends = Q + np.linspace(0, 0.1, 51)[1:, None] * np.array([1.0, -1.0])
    fine = plant.advance(ends, np.zeros((50, 6)), PERIOD)
    plant.reset(Q)
    coarse = plant.advance(ends[9::10], np.zeros((5, 6)), 10 * PERIOD)
    np.testing.assert_allclose(fine.q, coarse.q, atol=1e-12)


def test_same_again_and_in_pieces(plant: Plant) -> None:
    commands = Q + 0.02 * np.sin(np.arange(100) / 10)[:, None]
    whole = plant.advance(commands, np.zeros((100, 6)), PERIOD)
    plant.reset(Q)
    pieces = [plant.advance(commands[i : i + 1], np.zeros((1, 6)), PERIOD) for i in range(100)]
    np.testing.assert_array_equal(Trace.concatenate(pieces).q, whole.q)


def test_trace_is_of_one_instant(plant: Plant) -> None:
    """Every quantity of a trace fits the state it belongs to: recompute all of them from q and theta."""
    trace = hold(plant, 20, -100)
    model, at = plant.model, plant.compiled.at
    data = mujoco.MjData(model)
    for t in (0, 37, 79):
        data.qpos[at.q], data.qpos[at.theta] = trace.q[t], trace.theta[t]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_tendon(model, data)
        np.testing.assert_allclose(trace.reflectors[t], data.site_xpos[at.reflectors], atol=1e-12)
        np.testing.assert_allclose(trace.load_point[t], data.site_xpos[at.load_point], atol=1e-12)
        np.testing.assert_allclose(
            trace.counterbalance_length[t], data.ten_length[at.counterbalance_tendon], atol=1e-12
        )
    np.testing.assert_allclose(np.diff(trace.time), plant.timestep, rtol=1e-9)
    assert trace.wrench[0, 2] == 0
    assert trace.wrench[-1, 2] == -100


def test_wrench_acts_at_the_load_point_in_world_axes(plant: Plant, rng: np.random.Generator) -> None:
    model, data, at = plant.model, plant.data, plant.compiled.at
    data.qpos[at.theta] = rng.uniform(-1, 1, 2)
    wrench = rng.normal(size=6)
    data.xfrc_applied[at.load_body] = wrench
    mujoco.mj_forward(model, data)
    jacobian = np.zeros((2, 3, model.nv))
    mujoco.mj_jacSite(model, data, jacobian[0], jacobian[1], at.load_point)
    with_wrench = data.qfrc_smooth.copy()
    data.xfrc_applied[at.load_body] = 0
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(with_wrench - data.qfrc_smooth, jacobian.reshape(6, -1).T @ wrench, atol=1e-9)


def test_proportional_servo_rests_with_the_error_that_carries_the_arm(small_robot: Path) -> None:
    plant = Plant(load_robot(small_robot), [friction_on("none"), proportional_servo])
    plant.reset(Q)
    assert np.ptp(hold(plant, 250).q, axis=0).max() < 1e-11
    loaded = hold(plant, 2500, -250)
    kp = -plant.model.actuator_biasprm[plant.compiled.at.servo, 1]
    np.testing.assert_allclose(loaded.motor_torque[-1], kp * (Q - loaded.q[-1]), rtol=1e-9)
    assert np.all(np.abs(loaded.q[-1] - Q) > 1e-4)
