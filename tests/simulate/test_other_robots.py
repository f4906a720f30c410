"""Other robots than the first: a joint that slides, drives that report torque, no tracker, encoders at links."""

import numpy as np
import pytest

from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.simulate.drive import Log, stacked
from bench.simulate.env import BenchEnv
from bench.simulate.equilibrium import Equilibrium
from bench.simulate.instruments import Instruments
from bench.simulate.plant import Plant
from bench.simulate.policy import Mark, Step
from bench.simulate.tables import Joints, run_of, with_link_angles
from bench.simulate.trace import Trace

READINGS = 2000  # of one state, from which a noise level is told to within 5 %


@pytest.fixture(scope="module")
def emps() -> Plant:
    return Plant(load_robot("emps"))


def test_a_slide_moves_and_gives_as_its_servo_and_gear_do(emps: Plant) -> None:
    compiled = emps.compiled
    assert compiled.is_slide == (True,)
    push = 60.0  # [N]
    kp = -compiled.model.actuator_biasprm[compiled.at.servo, 1]
    theta = Equilibrium(compiled).solve(np.array([0.1]), np.array([push, 0, -200, 0, 0, 0]))
    np.testing.assert_allclose(theta, 0.1 + push / kp + push / compiled.stiffness, rtol=1e-9)

    emps.reset(np.array([0.1]))
    commands, wrenches = np.full((500, 1), 0.1), np.tile([push, 0, -200.0, 0, 0, 0], (500, 1))
    last = emps.advance(commands, wrenches, 4e-3)[-1:]
    np.testing.assert_allclose(last.theta[0], theta, rtol=1e-6)
    np.testing.assert_allclose(last.motor_torque[0], -push, rtol=1e-3)


def test_columns_of_a_slide_and_of_a_drive_that_reports_force(emps: Plant, rng: np.random.Generator) -> None:
    env = BenchEnv("emps", truth=True)
    env.reset(seed=1)
    log = Log()
    for i in range(4):
        step = Step(np.array([1e-3 * i]), np.zeros(6), Mark("sweep"))
        observation, *_, info = env.step({"q_cmd": step.q_cmd, "wrench": step.wrench})
        log.steps.append(step)
        log.instants.append(info["truth"])
        log.observations.append(observation)
        log.payload_kg.append(0.0)
    reading = stacked(log.observations, log.instants)
    run = run_of("sweep", log, reading, env.plant.model.opt.gravity, False, Joints.of(env.plant.compiled))
    measured = {"time_s", "q_cmd_1_m", "q_motor_1_m", "tau_motor_1_n"}
    assert {name for name in run.columns if not name.startswith("load_")} == measured
    assert "q_link_1_m" in with_link_angles(run, log, Trace.concatenate(log.instants)).columns


def test_noise_of_each_drive_and_which_links_have_encoders(rng: np.random.Generator) -> None:
    compiled = compile_robot(load_robot("kr300"))
    plant = Plant(compiled.robot)
    still = Trace.concatenate([plant.look()] * READINGS)
    figures = compiled.robot.figures.instruments.torque
    assert figures
    reading = Instruments(compiled, rng).read(still)
    np.testing.assert_allclose(reading.torque.std(axis=0), figures.sigma_of(6), rtol=0.1)
    drawn = [Instruments(compiled, np.random.default_rng(seed)).errors.torque_offset for seed in range(400)]
    np.testing.assert_allclose(np.std(drawn, axis=0), figures.offset_sigma_of(6), rtol=0.15)
    assert np.isnan(reading.current).all()
    np.testing.assert_array_equal(np.isnan(reading.q_link).all(axis=0), [False] * 3 + [True] * 3)
    assert np.ptp(reading.q_link[:, :3] - still.theta[:, :3], axis=0).max() < 1e-6  # a constant, and the resolution
    perfect = Instruments(compiled, None).read(still)
    np.testing.assert_array_equal(perfect.torque, still.motor_torque)
    np.testing.assert_array_equal(perfect.q_link[:, :3], still.theta[:, :3])
    joints = Joints.of(compiled)
    assert joints.has_link_encoder == (True,) * 3 + (False,) * 3
    assert not any(joints.is_slide)
