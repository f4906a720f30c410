"""models/kr300 follows from the published figures, and the recorded torque is that of this arm."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

from bench.identify.arm import Arm
from bench.identify.rigid_motion_fit import Filtering, MotionFit, axis_columns, fit_motion, model_torque, smooth_motion
from bench.record.convert import convert
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from bench.robot.links import rigid_bodies
from bench.robot.logs import log_format_of
from bench.robot.payload import with_payload
from bench.robot.plugins import configure
from tests.recordings import data_folder

KR300 = Path(__file__).parents[2] / "models" / "kr300"
PAYLOAD = 150.0  # [kg], the middle of what the data set's authors modelled; the recording does not state it
FILTERING = Filtering(order=4, cutoff_hz=10.0, decimation=5)  # at 250 Hz; the arm's lowest modes lie at 7 Hz
SIGNS_RIGHT = {0: 0.95, 1: 0.9, 2: 0.85, 3: 0.75, 4: 0.95, 5: 0.9}  # least R^2 by axis


@pytest.fixture(scope="module")
def full() -> CompiledRobot:
    """Return the robot with gas in its counterbalance."""
    return compile_robot(load_robot("kr300"), [lambda spec, robot: configure(spec, "cbs", gas_amount=1.0)])


def test_file_follows_from_the_published_figures() -> None:
    spec = importlib.util.spec_from_file_location("derive_kr300", KR300 / "derive.py")
    assert spec
    assert spec.loader
    derive = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(derive)
    robot = json.loads((data_folder("kr300") / "robot.json").read_text())
    assert derive.mjcf(robot) == (KR300 / "kr300.xml").read_text()


def test_nominal_counterbalance_is_empty_and_can_be_filled(full: CompiledRobot) -> None:
    assert compile_robot(load_robot("kr300")).counterbalance is None
    closed = full.counterbalance
    assert closed
    np.testing.assert_allclose(np.rad2deg(closed.dead_centre), -5.0, atol=1e-9)
    np.testing.assert_allclose([closed.rho, closed.b], [0.8, 0.2], rtol=1e-9)
    np.testing.assert_allclose(closed.gas_constant, 0.159 * 1.01 * 296.8 * 328, rtol=1e-6)
    half = compile_robot(load_robot("kr300"), [lambda spec, robot: configure(spec, "cbs", gas_amount=0.5)])
    assert half.counterbalance
    np.testing.assert_allclose(half.counterbalance.torque(0.5), closed.torque(0.5) / 2, rtol=1e-12)


def test_zero_is_upright_with_a_level_forearm(full: CompiledRobot) -> None:
    arm = Arm(rigid_bodies(full))
    position, rotation = arm.pose(np.zeros(6), "load_point")
    # 0.35 + 1.0 + 0.24 + 0.1 forward, 0.675 + 1.15 - 0.041 up
    np.testing.assert_allclose(position, [1.69, 0, 1.784], atol=1e-9)
    np.testing.assert_allclose(rotation[:, 2], [1, 0, 0], atol=1e-9)  # the flange's z looks forward


def fits(full: CompiledRobot, sign: np.ndarray) -> list[MotionFit]:
    """Fit the recorded torque axis by axis, with the angles and torques of some axes turned."""
    log = data_folder("kr300") / "recording_a.csv"
    (run,) = convert(log, log_format_of(load_robot("kr300")), "kr300").campaign.runs
    keys = tuple("123456")
    motion = smooth_motion(run.columns["time_s"], sign * run.stack("q_motor", "rad", keys), FILTERING)
    torque = sign * run.stack("tau_motor", "nm", keys)
    arm = Arm(with_payload(rigid_bodies(full), PAYLOAD, "load_point"))
    expected = model_torque(arm, full.model.dof_armature[full.at.q_dof], motion)
    found = []
    for j in range(6):
        columns = axis_columns(motion, j) | {"inertia": expected[:, j]}
        if full.counterbalance and full.counterbalance.joint == j:
            columns["counterbalance"] = full.counterbalance.torque(motion.position[:, j])
        found.append(fit_motion(columns, torque[:, j], FILTERING))
    return found


def test_recorded_torque_is_that_of_this_arm(full: CompiledRobot) -> None:
    right = fits(full, np.ones(6))
    for j, least in SIGNS_RIGHT.items():
        assert right[j].r_squared > least, j
        assert 0.8 < right[j]["inertia"] < 2.0, j
        assert right[j]["coulomb"] > 0, j
        assert right[j]["viscous"] > 0, j
    assert 0.5 < right[1]["counterbalance"] < 1.2


@pytest.mark.parametrize("axis", [1, 2, 4])
def test_a_turned_axis_would_be_noticed(full: CompiledRobot, axis: int) -> None:
    sign = np.ones(6)
    sign[axis] = -1
    turned, right = fits(full, sign), fits(full, np.ones(6))
    assert turned[axis].relative_error > 1.5 * right[axis].relative_error
