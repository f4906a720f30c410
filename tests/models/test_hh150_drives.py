"""Servo, friction and elements of hh150.xml at work: stability, rest, settling."""

import json
from types import ModuleType

import mujoco
import numpy as np
import pytest

from tests.models.conftest import HH150, JOINTS, put, rotor_dofs, theta_dofs

PAYLOAD = 150.0  # [kg]
A1 = json.loads((HH150 / "paper" / "configurations.json").read_text())["A1"]["q_deg"]
POSES = {"home": (0, 0, 0, 0, 90, 0), "zero": (0,) * 6, "stretched": (0, 90, -90, 0, 0, 0)}
POSES |= {f"A1-{i}": tuple(q) for i, q in enumerate(A1, start=1)}
POLE_ERROR = 0.10  # relative; the step of 1 ms moves the fast poles, linearisation neglects gravity and cylinder


def servo_torque(data: mujoco.MjData) -> np.ndarray:
    return np.array([data.actuator(f"servo{i}").force[0] for i in JOINTS])


def command(model: mujoco.MjModel, data: mujoco.MjData, q: np.ndarray) -> None:
    data.ctrl[model.actuator_ctrladr[[model.actuator(f"servo{i}").id for i in JOINTS]]] = q


def settle(model: mujoco.MjModel, data: mujoco.MjData, seconds: float) -> None:
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)


def step_eigenvalues(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    size = 2 * model.nv + model.na
    transition = np.zeros((size, size))
    mujoco.mjd_transitionFD(model, data, 1e-7, True, transition, None, None, None)
    return np.linalg.eigvals(transition)


def with_payload(model: mujoco.MjModel, payload: float) -> mujoco.MjModel:
    body = model.body("load").id
    model.body_mass[body] = payload
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model


@pytest.mark.parametrize("payload", [0.0, PAYLOAD])
@pytest.mark.parametrize("pose", POSES)
def test_loop_is_stable_when_friction_slips(
    slippery: mujoco.MjModel, derive: ModuleType, pose: str, payload: float
) -> None:
    model, q = with_payload(slippery, payload), np.deg2rad(POSES[pose])
    data = mujoco.MjData(model)
    command(model, data, q)
    put(model, data, q)
    eigenvalues = step_eigenvalues(model, data)
    assert np.abs(eigenvalues).max() < 1

    slowest = np.log(eigenvalues.astype(complex)).real.max() / model.opt.timestep
    np.testing.assert_allclose(slowest, derive.loop_poles(q, payload, False).real.max(), rtol=POLE_ERROR)


@pytest.mark.parametrize("payload", [0.0, PAYLOAD])
@pytest.mark.parametrize("pose", POSES)
def test_loop_is_stable_when_friction_is_stuck(derive: ModuleType, pose: str, payload: float) -> None:
    model, q = with_payload(mujoco.MjModel.from_xml_path(str(HH150 / "hh150.xml")), payload), np.deg2rad(POSES[pose])
    data = mujoco.MjData(model)
    command(model, data, q)
    put(model, data, q)
    mujoco.mj_step(model, data)  # friction takes hold in the first step
    assert np.abs(step_eigenvalues(model, data)).max() < 1
    assert derive.loop_poles(q, payload, True).real.max() < 0


def test_home_is_a_state_of_rest(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    start = data.qpos.copy()
    settle(model, data, 2.0)
    np.testing.assert_allclose(data.qpos, start, atol=1e-8)
    np.testing.assert_allclose(data.qvel, 0, atol=1e-8)
    np.testing.assert_allclose(data.qpos[rotor_dofs(model)], np.deg2rad(POSES["home"]), atol=1e-8)


@pytest.mark.parametrize("pose", ["home", "A1-1", "A1-5"])
def test_motor_angle_equals_the_command_at_rest(model: mujoco.MjModel, data: mujoco.MjData, pose: str) -> None:
    """Under the rated force, with friction, as fast as README.md says."""
    q = np.deg2rad(POSES[pose])
    command(model, data, q)
    put(model, data, q)
    settle(model, data, 4.0)
    load, down = model.body("load").id, np.array([0, 0, -1500.0])
    ramp = round(0.5 / model.opt.timestep)
    for step in range(ramp):
        data.xfrc_applied[load, :3] = down * (step + 1) / ramp
        mujoco.mj_step(model, data)
    for seconds, error in ((1.0, 4e-6), (1.0, 6e-7), (5.0, 1e-9)):
        settle(model, data, seconds)
        np.testing.assert_allclose(data.qpos[rotor_dofs(model)], q, rtol=0, atol=error)
    assert np.abs(servo_torque(data)).max() < model.actuator_forcerange[:, 1].max()


def test_static_deflection_without_friction_is_compliance_times_torque(
    slippery: mujoco.MjModel, derive: ModuleType
) -> None:
    """The sag is tau / k, with the torque of gravity and cylinder at the deflected pose."""
    q = np.deg2rad(POSES["A1-1"])
    data = mujoco.MjData(slippery)
    command(slippery, data, q)
    put(slippery, data, q)
    settle(slippery, data, 12.0)
    theta = data.qpos[theta_dofs(slippery)]
    torque = derive.arm.holding_torque(theta)
    np.testing.assert_allclose(servo_torque(data), torque, rtol=1e-6, atol=1e-3)
    np.testing.assert_allclose(theta, q - torque / derive.STIFFNESS, atol=1e-9)


def test_time_step_hardly_matters_at_rest() -> None:
    """The tool under load stands within 1 um of where a quarter of the time step puts it, as README.md says."""
    stands = []
    for refinement in (1, 4):
        model = mujoco.MjModel.from_xml_path(str(HH150 / "hh150.xml"))
        model.opt.timestep /= refinement
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
        while data.time < 4.0:
            data.xfrc_applied[model.body("load").id, :3] = np.array([300, 400, -1400]) * min(1.0, 2 * data.time)
            mujoco.mj_step(model, data)
        stands.append(data.site("reference_point").xpos.copy())
    np.testing.assert_allclose(stands[0], stands[1], rtol=0, atol=1e-6)


def test_friction_elements_keep_the_step_rule(derive: ModuleType) -> None:
    """sqrt(sigma / J) dt is below 0.7 for each element, below 1 for the six of the arm together; 2 is unstable."""
    drives = derive.drives()
    step = derive.COARSEST_STEP
    alone, together = 0.0, 0.0
    for q in derive.poses():
        mass = derive.arm.mass_matrix(q)
        inertia = 1 / np.diag(np.linalg.inv(mass))
        alone = max(alone, np.sqrt(drives.link_presliding / inertia).max() * step)
        fastest = np.linalg.eigvals(np.linalg.solve(mass, np.diag(drives.link_presliding))).real.max()
        together = max(together, np.sqrt(fastest) * step)
    assert alone < 0.7005  # sigma is rounded to three digits
    assert together < 1
    assert (np.sqrt(drives.motor_presliding / drives.inertia) * step).max() < 0.7


def test_friction_remembers_where_the_arm_came_from(
    model: mujoco.MjModel, data: mujoco.MjData, derive: ModuleType
) -> None:
    """Approached from below or from above, a pose is held with torques that differ by up to twice the friction."""
    held = []
    for sign in (-1, 1):
        mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
        home = np.deg2rad(POSES["home"])
        for step in range(round(2 / model.opt.timestep)):
            away = np.sin(np.pi * min(step * model.opt.timestep, 1.0)) ** 2  # there and back within 1 s
            command(model, data, home + sign * 0.02 * away)
            mujoco.mj_step(model, data)
        settle(model, data, 3.0)
        held.append(servo_torque(data))
    both_sides = 2 * (derive.drives().motor_friction + derive.drives().link_friction)
    difference = np.abs(held[0] - held[1])
    assert (difference < 1.001 * both_sides).all()  # the sag differs too, and gravity with it
    assert (difference > 0.4 * both_sides).all()
