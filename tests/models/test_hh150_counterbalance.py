"""The counterbalance of hh150.xml against Eqs. (8), (9), (11), (12) in closed form."""

import json
from dataclasses import dataclass

import mujoco
import numpy as np
import pytest

from tests.models.conftest import HH150, put, theta_dofs

C, L_C = 4771.4, 0.9112  # [Nm], [m], Eq. (47)
B, RHO = 0.20, 0.70  # [m], reconstructed
ALPHA = np.deg2rad(3.3)  # [rad], Eq. (10) with theta_2 as DH angle
SWEEP = np.deg2rad(np.arange(-40.0, 110.1, 2.5))
EXACT = 1e-9  # relative: geometry in double precision, anchors written to 12 digits
STEP = 1e-4  # [rad], of the central differences
DIFFERENCES = 1e-6  # relative to the largest value: STEP^2 / 6 times a third derivative, and rounding


def dh(theta_2: np.ndarray) -> np.ndarray:
    """Return the angle that the paper's equations mean by theta_2."""
    return theta_2 - np.pi / 2


def length(theta_2: np.ndarray) -> np.ndarray:
    """Eq. (9)."""
    return np.sqrt(B**2 + RHO**2 - 2 * B * RHO * np.sin(ALPHA - dh(theta_2)))


def balancing_torque(theta_2: np.ndarray) -> np.ndarray:
    """Eq. (11)."""
    return C / (length(theta_2) * (L_C - length(theta_2))) * B * RHO * np.cos(ALPHA - dh(theta_2))


def stiffness(theta_2: np.ndarray) -> np.ndarray:
    """k_b, Eq. (12)."""
    long, angle = length(theta_2), ALPHA - dh(theta_2)
    first = C * B * RHO * np.sin(angle) / (long * (L_C - long))
    return first - C * B**2 * RHO**2 * (L_C - 2 * long) * np.cos(angle) ** 2 / (long**3 * (L_C - long) ** 2)


@dataclass(frozen=True)
class Cylinder:
    """What MuJoCo makes of the cylinder over a sweep of joint 2: each shape (n,)."""

    length: np.ndarray  # [m]
    lever_arm: np.ndarray  # [m], dl/dtheta_2
    pull: np.ndarray  # [N]
    torque: np.ndarray  # [Nm], on joint 2, in the direction of growing theta_2


def sweep(model: mujoco.MjModel, theta_2: np.ndarray) -> Cylinder:
    data, tendon, values = mujoco.MjData(model), model.tendon("cbs").id, []
    row = slice(model.ten_J_rowadr[tendon], model.ten_J_rowadr[tendon] + model.ten_J_rownnz[tendon])
    for angle in theta_2:
        put(model, data, np.array([0.3, angle, -0.4, 0.2, 0.7, 0.1]))
        moments = np.zeros(model.nv)
        moments[model.ten_J_colind[row]] = data.ten_J[row]
        moment = moments[theta_dofs(model)[1]]
        assert np.abs(np.delete(moments, theta_dofs(model)[1])).max() < EXACT, "the cylinder acts on joint 2 alone"
        force = data.actuator("cbs").force[0]
        values.append((data.ten_length[tendon], moment, -force, force * moment))
    return Cylinder(*np.array(values).T)


@pytest.fixture(scope="module")
def cylinder(model: mujoco.MjModel) -> Cylinder:
    return sweep(model, SWEEP)


def test_length_and_lever_arm_are_eq_9(cylinder: Cylinder) -> None:
    np.testing.assert_allclose(cylinder.length, length(SWEEP), rtol=EXACT)
    lever_arm = B * RHO * np.cos(ALPHA - dh(SWEEP)) / length(SWEEP)
    np.testing.assert_allclose(cylinder.lever_arm, lever_arm, rtol=EXACT, atol=EXACT)


def test_force_and_torque_are_eqs_8_and_11(cylinder: Cylinder) -> None:
    np.testing.assert_allclose(cylinder.pull, C / (L_C - length(SWEEP)), rtol=EXACT)
    np.testing.assert_allclose(-cylinder.torque, balancing_torque(SWEEP), rtol=EXACT, atol=1e-6)


def test_stiffness_is_eq_12(model: mujoco.MjModel) -> None:
    ahead, behind = sweep(model, SWEEP + STEP), sweep(model, SWEEP - STEP)
    measured = -(ahead.torque - behind.torque) / (2 * STEP)
    expected = stiffness(SWEEP)
    np.testing.assert_allclose(measured, expected, atol=DIFFERENCES * np.abs(expected).max())
    assert 0.002 < expected.max() / 1.435e6 < 0.0045  # small against k_2^0, which the paper's Fig. 13 does not suggest


def test_it_is_silent_at_the_dead_centre_and_restores_on_both_sides(model: mujoco.MjModel) -> None:
    behind, centre, ahead = sweep(model, ALPHA + np.deg2rad([-5.0, 0.0, 5.0])).torque
    assert abs(centre) < 1e-6  # [Nm]
    assert behind > 0 > ahead


def test_reference_figures(model: mujoco.MjModel, cylinder: Cylinder) -> None:
    """As reconstructed: 2.0, 3.1, 4.8, 6.3 kNm at 40, 60, 90, 110 deg; l 0.500 to 0.781 m; F 11.6 to 36.7 kN."""
    torque = -sweep(model, np.deg2rad([40.0, 60.0, 90.0, 110.0])).torque
    np.testing.assert_allclose(torque / 1e3, [2.0, 3.1, 4.8, 6.3], atol=0.05)
    np.testing.assert_allclose([cylinder.length.min(), cylinder.length.max()], [0.500, 0.781], atol=5e-4)
    np.testing.assert_allclose([cylinder.pull.min() / 1e3, cylinder.pull.max() / 1e3], [11.6, 36.7], atol=0.05)


def test_torque_at_the_reconstructed_poses(model: mujoco.MjModel) -> None:
    a1 = json.loads((HH150 / "paper" / "configurations.json").read_text())["A1"]
    torque = -sweep(model, np.deg2rad(a1["q_deg"])[:, 1]).torque
    np.testing.assert_allclose(torque, a1["gravity_fit"]["b0.2_rho0.7"]["M_Nm"], atol=0.01)  # q2 has four decimals
