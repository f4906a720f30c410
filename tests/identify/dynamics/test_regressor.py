"""Regressor times parameters is inverse dynamics, Pinocchio's and MuJoCo's; a payload is a body at the load point."""

from dataclasses import replace

import numpy as np

from bench.identify.arm import Arm
from bench.identify.dynamics.base_parameters import base_parameters
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.regressor import (
    N_INERTIAL,
    link_regressor,
    links_with,
    payload_columns,
    standard_parameters,
)
from bench.robot.bodies import read_only
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot, robot_names
from bench.robot.links import inertial_parameters, poses_of, rigid_bodies
from bench.robot.payload import with_payload
from tests.identify.dynamics.rigid_world import N, arm, robot, torque_of

EXACT = 1e-9  # of the largest torque


def states(rng: np.random.Generator, n: int) -> np.ndarray:
    return rng.standard_normal((3, 40, n))


def test_regressor_times_parameters_is_inverse_dynamics(rng: np.random.Generator) -> None:
    for bodies in (arm(), rigid_bodies(compile_robot(load_robot("kr300")))):
        model = Arm(bodies)
        q, v, a = states(rng, bodies.n_joints)
        expected = np.array([model.inverse_dynamics(*state) for state in zip(q, v, a, strict=True)])
        found = link_regressor(model, q, v, a) @ standard_parameters(model.bodies)
        np.testing.assert_allclose(found, expected, rtol=0, atol=EXACT * np.abs(expected).max())


def test_parameters_of_a_model_are_those_of_its_links() -> None:
    for name in robot_names():
        compiled = compile_robot(load_robot(name))
        expected = standard_parameters(rigid_bodies(compiled))
        found = inertial_parameters(compiled, poses_of(compiled))
        np.testing.assert_allclose(found, expected, rtol=0, atol=EXACT * np.abs(expected).max())


def test_it_is_that_of_another_engine(rng: np.random.Generator) -> None:
    nominal = robot(arm())
    q, v, a = states(rng, N)
    expected = torque_of(nominal, q, v, a)
    model = Arm(nominal.bodies)
    found = link_regressor(model, q, v, a) @ standard_parameters(model.bodies) + nominal.rotor_inertia * a
    np.testing.assert_allclose(found, expected, rtol=0, atol=EXACT * np.abs(expected).max())


def test_payload_is_a_point_mass_at_the_load_point(rng: np.random.Generator) -> None:
    model = Arm(arm())
    body, columns = payload_columns(model, "hook")
    q, v, a = states(rng, N)
    links = link_regressor(model, q, v, a)
    found = links @ standard_parameters(model.bodies) + links[:, :, 10 * body : 10 * body + 10] @ columns[:, 0] * 7.5
    loaded = Arm(with_payload(arm(), 7.5, "hook"))
    expected = np.array([loaded.inverse_dynamics(*state) for state in zip(q, v, a, strict=True)])
    np.testing.assert_allclose(found, expected, rtol=0, atol=EXACT * np.abs(expected).max())


def test_base_parameters_are_all_that_torque_depends_on(rng: np.random.Generator) -> None:
    """What has no share in a base parameter changes no torque; an upright arm of six axes has 40 with rotors."""
    bodies = rigid_bodies(compile_robot(load_robot("kr300")))
    layout = Layout(6, False, False)
    base = base_parameters(Arm(bodies), layout, "load_point")
    assert len(base.names) == 40  # W. Khalil, E. Dombre, "Modeling, Identification and Control of Robots", 2002, RX-90
    inertial = np.concatenate([np.arange(60), np.arange(layout.size)[layout.of_drives("rotor")]])
    _, size, rows = np.linalg.svd(base.combine[:, inertial])
    hidden = rows[len(size) :]
    q, v, a = states(rng, 6)
    links = link_regressor(Arm(bodies), q, v, a)
    for direction in hidden:
        change = links @ direction[:60] + direction[60:] * a
        np.testing.assert_allclose(change, 0, atol=1e-8 * np.abs(links).max())


def test_links_take_other_parameters_and_thin_bodies_too() -> None:
    """Bodies that the constraints let be thinner than a plate ended in Pinocchio's RuntimeError."""
    bodies = arm()
    own = standard_parameters(bodies).reshape(-1, N_INERTIAL)
    again = links_with(bodies, own)
    np.testing.assert_allclose(standard_parameters(again).reshape(-1, N_INERTIAL), own, atol=1e-9)
    thin = own.copy()
    thin[:, 4:] *= 1 - 1e-4  # a point's inertia about its joint, and less
    thin[0] = 0.0
    assert np.all(np.isfinite(Arm(links_with(bodies, thin)).gravity(np.zeros(len(own)))))


def test_sums_of_base_parameters_have_no_rounding_in_them() -> None:
    """A payload straight ahead of a wrist was told with "- 8.33e-17 payload my"."""
    hook = replace(arm().points["hook"], position=read_only([0.0, 0.1, 0.0]))
    model = Arm(replace(arm(), points={"hook": hook}))
    combine = base_parameters(model, Layout(N, True, False), "hook").combine
    assert np.abs(combine[combine != 0]).min() > 1e-6
