"""Masses of hh150.xml: reconstructed moments, mass matrix and gravity against the second model in arm.py."""

import json
from types import ModuleType

import mujoco
import numpy as np

from bench.robot.mass_matrix import mass_matrix
from tests.models.conftest import HH150, JOINTS, put, random_angles, rotor_dofs, theta_dofs

POSES = 50
ROUNDING = 2e-4  # the XML holds inertias and armatures rounded to four digits
EXACT = 1e-9  # relative


def test_first_moments_are_the_reconstructed_ones(model, data) -> None:
    """A: upper arm and all beyond, along it; S: forearm and all beyond, along it; Tz: wrist and beyond, along z6."""
    expected = json.loads((HH150 / "paper" / "parameters.json").read_text())["masses"]["first_moments_kgm"]
    put(model, data, np.zeros(6))

    def moment(first: str) -> np.ndarray:
        """Return mass times centre [kg m] of a link and all beyond, from that link's joint."""
        body = model.body(first).id
        return model.body_subtreemass[body] * (data.subtree_com[body] - data.xpos[body])

    # At zero upper arm, forearm and tool lie along z, x and x, and z6 along -x.
    np.testing.assert_allclose(moment("upper_arm"), [expected["S"] - expected["Tz"], 0, expected["A"]], atol=1e-9)
    np.testing.assert_allclose(moment("forearm"), [expected["S"] - expected["Tz"], 0, 0], atol=1e-9)
    np.testing.assert_allclose(moment("wrist"), [-expected["Tz"], 0, 0], atol=1e-9)


def test_mass_matrix_and_gravity_agree_with_the_second_model(model, data, derive: ModuleType, rng) -> None:
    links = theta_dofs(model)
    for _ in range(POSES):
        q = random_angles(model, rng)
        put(model, data, q)
        expected = derive.arm.mass_matrix(q)
        difference = mass_matrix(model, data)[np.ix_(links, links)] - expected
        assert np.abs(difference).max() < ROUNDING * np.abs(expected).max()
        np.testing.assert_allclose(data.qfrc_bias[links], derive.arm.gravity_torque(q), rtol=EXACT, atol=1e-8)


def test_rotors_couple_to_nothing_but_their_element(model, data, rng) -> None:
    put(model, data, random_angles(model, rng))
    data.qvel[rotor_dofs(model)] = rng.normal(size=6)
    mujoco.mj_forward(model, data)
    matrix = mass_matrix(model, data)
    rotors, links = rotor_dofs(model), theta_dofs(model)
    armature = np.array([model.joint(f"rotor{i}").armature[0] for i in JOINTS])
    np.testing.assert_allclose(matrix[np.ix_(rotors, rotors)], np.diag(armature), rtol=1e-6, atol=1e-12)
    assert not matrix[np.ix_(rotors, links)].any()
    np.testing.assert_allclose(data.qfrc_bias[rotors], 0, atol=1e-12)


def test_element_torque_is_k_times_q_minus_theta(model, data, rng) -> None:
    links, rotors = theta_dofs(model), rotor_dofs(model)
    theta, twist = random_angles(model, rng), 1e-3 * rng.normal(size=6)
    data.qpos[links], data.qpos[rotors] = theta, theta + twist
    mujoco.mj_forward(model, data)
    stiffness = np.array([0.559, 1.435, 1.829, 0.184, 0.171, 0.070]) * 1e6  # Table 6
    np.testing.assert_allclose(data.qfrc_spring[links], stiffness * twist, rtol=EXACT)
    np.testing.assert_allclose(data.qfrc_spring[rotors], -stiffness * twist, rtol=EXACT)


def test_nothing_collides(model, data) -> None:
    put(model, data, np.deg2rad([0, 110, 54, 0, 120, 0]))
    assert data.ncon == 0
    assert not model.geom_contype.any()
    assert not model.geom_conaffinity.any()
