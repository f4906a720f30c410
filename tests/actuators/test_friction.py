"""Friction that holds: closed-form paths, no creep, no energy out of nothing, the limit of the time step."""

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.actuators.laws import Friction, return_map
from bench.actuators.state import HELD, begin_with, state_of
from tests.actuators.slider import TIMESTEP, follow, slider

SIGMA, LEVEL = 1e6, 100.0
SLIP = LEVEL / SIGMA  # displacement at which an unstressed element begins to slide
ROUNDING = 1e-9  # [N] of forces around 100 N
PLAIN = Friction(coulomb=LEVEL, presliding_stiffness=SIGMA)


def test_loading_and_reversal_in_closed_form():
    """Out from rest: f = -min(sigma x, L). Back from the turn: f = -L + sigma (turn - x), up to L."""
    out = np.linspace(0, 5 * SLIP, 57)
    back = np.linspace(5 * SLIP, -3 * SLIP, 101)[1:]
    forces = follow(slider(PLAIN), np.concatenate([out, back]))[:, 0]
    expected = np.concatenate([-np.minimum(SIGMA * out, LEVEL), np.minimum(-LEVEL + SIGMA * (out[-1] - back), LEVEL)])
    np.testing.assert_allclose(forces, expected, atol=ROUNDING)


def test_result_does_not_depend_on_the_steps_of_a_monotone_path():
    fine, coarse = np.linspace(0, 3 * SLIP, 1000), np.linspace(0, 3 * SLIP, 4)
    assert follow(slider(PLAIN), fine)[-1, 0] == pytest.approx(follow(slider(PLAIN), coarse)[-1, 0], abs=ROUNDING)


def test_small_cycles_below_the_level_are_elastic():
    x = 0.4 * SLIP * np.sin(np.linspace(0, 40 * np.pi, 4001))
    np.testing.assert_allclose(follow(slider(PLAIN), x)[:, 0], -SIGMA * x, atol=ROUNDING)


def test_direction_and_speed_set_the_level():
    law = Friction(coulomb=LEVEL, presliding_stiffness=SIGMA, asymmetry=0.2, static_rise=0.3, stribeck_velocity=0.05)
    x = np.array([0, 5, 0]) * SLIP
    sliding = follow(slider(law), x, v=[0, 1, -1])[1:, 0]
    np.testing.assert_allclose(sliding, [-LEVEL * 1.2, LEVEL * 0.8], rtol=1e-12)
    at_stribeck_velocity = follow(slider(law), x, v=[0, 0.05, -0.05])[1:, 0]
    rise = 1 + 0.3 / np.e
    np.testing.assert_allclose(at_stribeck_velocity, [-LEVEL * 1.2 * rise, LEVEL * 0.8 * rise], rtol=1e-12)


@pytest.mark.parametrize("coefficient", [3.0, -3.0, 3 * LEVEL])
def test_drag_that_differs_between_directions(coefficient: float):
    law = Friction(coulomb=LEVEL, presliding_stiffness=SIGMA, viscous_asymmetry=coefficient)
    x = np.array([0, 5, 0, 5]) * SLIP
    speeds = [0, 0.5, -0.5, 0.25]
    sliding = follow(slider(law), x, v=speeds)[1:, 0]
    expected = [
        -max(LEVEL + 0.5 * coefficient, 0),
        max(LEVEL - 0.5 * coefficient, 0),
        -max(LEVEL + 0.25 * coefficient, 0),
    ]
    np.testing.assert_allclose(sliding, expected, rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(law.force(x, np.array(speeds))[1:], expected, rtol=1e-12, atol=1e-9)


def test_rolling_friction_grows_with_a_power_of_speed():
    law = Friction(coulomb=LEVEL, presliding_stiffness=SIGMA, rolling=7.0, asymmetry=0.2, rolling_asymmetry=-0.1)
    x, speeds = np.array([0, 5, 0, 5]) * SLIP, [0, 0.5, -0.125, 0.0]
    sliding = follow(slider(law), x, v=speeds)[1:, 0]
    expected = [-(1.2 * LEVEL + 0.9 * 7.0 * 0.5 ** (2 / 3)), 0.8 * LEVEL + 1.1 * 7.0 / 4, -1.2 * LEVEL]
    np.testing.assert_allclose(sliding, expected, rtol=1e-12)
    np.testing.assert_allclose(law.force(x, np.array(speeds))[1:], expected, rtol=1e-12)


def test_drag_goes_on_as_steep_as_it_is_and_falls_no_further():
    """A cubic that a stranger's arm was handed fell from 36 Nm at 1.5 rad/s to 3.7 at 3.3, where 65.8 were right."""
    x, speeds = np.array([0, 5, 0, 5, 0]) * SLIP, np.array([0, 1.0, -2.0, 3.0, -5.0])
    steep, fallen = 4.0 + 2 * 3.0 * 2.0 - 3 * 0.5 * 4.0, 4.0 * 2 + 3.0 * 4 - 4.0 * 8
    for cube, beyond in ((-0.5, (16.0, 16.0 + steep, 16.0 + 3 * steep)), (-4.0, (fallen,) * 3)):
        law = Friction(
            coulomb=LEVEL, presliding_stiffness=SIGMA, drag=4.0, drag_square=3.0, drag_cube=cube, drag_speed=2.0
        )
        expected = np.maximum(LEVEL + np.array([7.0 + cube, *beyond]), 0) * [-1, 1, -1, 1]
        np.testing.assert_allclose(law.force(x, speeds)[1:], expected, rtol=1e-12, atol=1e-9)
        np.testing.assert_allclose(follow(slider(law), x, v=speeds)[1:, 0], expected, rtol=1e-12, atol=1e-9)


COULOMB = np.array([900, 650, 300, 60, 25, 15])  # [Nm], about twice what the weight asks for
ARM = f"""
<mujoco>
  <option timestep="{TIMESTEP}" integrator="implicitfast"/>
  <extension><plugin plugin="bench.friction"/></extension>
  <default>
    <joint damping="30" armature="5"/>
    <geom type="capsule" size="0.05" fromto="0 0 0 0.3 0 0" mass="10" contype="0" conaffinity="0"/>
  </default>
  <worldbody>
    {
    "".join(
        f'<body name="link{i}" pos="{0.3 * (i > 0)} 0 0" euler="{20 * (i > 0)} 0 0">'
        f'<joint name="joint{i}" axis="0 1 {0.1 * i}"/><geom/>'
        for i in range(6)
    )
}
    {"</body>" * 6}
  </worldbody>
  <actuator>
    {
    "".join(
        f'<plugin name="friction{i}" plugin="bench.friction" joint="joint{i}">'
        f'<config key="coulomb" value="{level}"/><config key="presliding_stiffness" value="{1e4 * level}"/></plugin>'
        for i, level in enumerate([900, 650, 300, 60, 25, 15])
    )
}
  </actuator>
</mujoco>"""
HOLD = 10.0  # [s]
MOST_LOST = 1e-3  # of the Coulomb level, from the design of this bench


def test_six_joints_hold_their_weight():
    """From the friction torques that balance gravity, none moves or gives."""
    model = mujoco.MjModel.from_xml_string(ARM)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    weight = data.qfrc_bias.copy()
    assert np.all(np.abs(weight) > 0.2 * COULOMB)
    assert np.all(np.abs(weight) < COULOMB)
    for i in range(model.nu):
        begin_with(model, data, i, weight[i])
    mujoco.mj_step(model, data, int(HOLD / TIMESTEP))
    np.testing.assert_allclose(data.actuator_force, weight, atol=1e-9 * weight.max())
    np.testing.assert_allclose(data.qpos, 0, atol=1e-12)


def test_six_joints_come_to_rest_and_hold():
    """Dropped unstressed, they swing into the elastic range, then lose nothing more."""
    model = mujoco.MjModel.from_xml_string(ARM)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, int(20 / TIMESTEP))
    assert np.max(np.abs(data.qvel)) < 1e-9
    held = data.actuator_force.copy()
    mujoco.mj_step(model, data, int(HOLD / TIMESTEP))
    np.testing.assert_array_less(np.abs(data.actuator_force - held), MOST_LOST * COULOMB)


@settings(derandomize=True)
@given(st.lists(st.integers(-400, 400), min_size=1, max_size=60), st.integers(-90, 90), st.integers(-80, 80))
def test_friction_gives_no_energy(strides: list[int], asymmetry: int, start: int):
    """What is taken out never exceeds what the spring of the element had stored, for any path and any levels.

    Work with the force at the end of each step: -f dx = dE + (df)^2 / (2 sigma) - f slip, and f slip <= 0.
    """
    minus, plus = LEVEL * (1 - asymmetry / 100), LEVEL * (1 + asymmetry / 100)
    first = force = float(np.clip(start, -plus, minus))
    taken_out = 0.0
    for stride in strides:
        dx = stride / 100 * SLIP
        force = float(return_map(force, dx, SIGMA, minus, plus))
        taken_out += force * dx
    stored, left = first**2 / (2 * SIGMA), force**2 / (2 * SIGMA)
    assert taken_out <= stored - left + 1e-12 * LEVEL * SLIP


def test_stopping_distance():
    """It slides for m v^2 / (2 L) and then rings within the slip distance."""
    model = slider(PLAIN)
    data = mujoco.MjData(model)
    mass, speed = 10.0, 0.3
    data.qvel[0] = speed
    mujoco.mj_step(model, data, 400)
    assert data.qpos[0] == pytest.approx(mass * speed**2 / (2 * LEVEL), abs=SLIP + speed * TIMESTEP)
    assert mass * data.qvel[0] ** 2 <= LEVEL * SLIP


@pytest.mark.parametrize(("courant", "stable"), [(1.9, True), (2.1, False)])
def test_limit_of_the_time_step(courant: float, stable: bool):
    mass = 10.0
    sigma = mass * (courant / TIMESTEP) ** 2
    model = slider(Friction(coulomb=1e12, presliding_stiffness=sigma))
    data = mujoco.MjData(model)
    data.qvel[0] = 1e-6
    mujoco.mj_step(model, data, 20)
    assert (abs(data.qvel[0]) < 1e-4) == stable


def test_friction_begins_with_a_given_torque():
    model = slider(PLAIN)
    data = mujoco.MjData(model)
    data.qpos[0] = 0.7
    begin_with(model, data, 0, 60.0)
    mujoco.mj_forward(model, data)
    assert data.actuator_force[0] == 60
    mujoco.mj_step(model, data)
    data.qpos[0] = 0.7 + 0.1 * SLIP
    mujoco.mj_forward(model, data)
    assert data.actuator_force[0] == pytest.approx(50, abs=ROUNDING)
    begin_with(model, data, 0, 3 * LEVEL)
    mujoco.mj_step(model, data)
    assert state_of(model, data, 0)[HELD] == LEVEL
