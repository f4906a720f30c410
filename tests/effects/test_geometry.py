"""Effects of geometry and mass: arithmetic on the model, and what it does to torques."""

import numpy as np
import pytest

from bench.effects.conditions import Conditions
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import Robot
from bench.simulate.payload import bolt_on
from tests.effects.rest import CATALOGUE, edit_of, rest, sweep
from tests.small_robot import LINK, MASS

LEVEL = np.array([0.0, 0.0])  # first link upright, second one level
PAYLOAD = 20.0  # [kg]
G = 9.81  # [m/s^2]
SAG = 0.3  # [Nm]; links sag by some 1e-3 rad, which changes lever arms by less than 1e-3 of themselves


def extra_torque(robot: Robot, edits: list, base: list | None = None) -> np.ndarray:
    """Return what the effect adds to the motor torques in the level pose [Nm]; a weight takes negative torque."""
    base = base or []
    return rest(robot, [*base, *edits], LEVEL).torque - rest(robot, base, LEVEL).torque


def test_payload_mass(small: Robot, small_compiled: CompiledRobot) -> None:
    extra = extra_torque(small, [edit_of("payload_mass", small_compiled, {"change": 0.1})], [bolt_on(PAYLOAD)])
    np.testing.assert_allclose(extra, [-0.1 * PAYLOAD * G * LINK[1]] * 2, atol=SAG)


def test_payload_com(small: Robot, small_compiled: CompiledRobot) -> None:
    edit = edit_of("payload_com", small_compiled, {"x": 0.03, "z": -0.02})
    extra = extra_torque(small, [edit], [bolt_on(PAYLOAD)])
    np.testing.assert_allclose(extra, [-PAYLOAD * G * 0.03] * 2, atol=SAG)
    model = compile_robot(small, [bolt_on(PAYLOAD), edit]).model
    np.testing.assert_allclose(model.body_mass.sum(), small_compiled.model.body_mass.sum() + PAYLOAD)


def test_without_payload_neither_does_anything(small: Robot, small_compiled: CompiledRobot) -> None:
    edits = [
        edit_of("payload_mass", small_compiled, {"change": 0.1}),
        edit_of("payload_com", small_compiled, {"x": 0.03}),
    ]
    np.testing.assert_array_equal(extra_torque(small, edits), 0)


def test_link_mass(small: Robot, small_compiled: CompiledRobot) -> None:
    extra = extra_torque(small, [edit_of("link_mass", small_compiled, {"change": -0.2}, 1)])
    np.testing.assert_allclose(extra, [0.2 * MASS[1] * G * LINK[1] / 2] * 2, atol=SAG)


def test_link_com(small: Robot, small_compiled: CompiledRobot) -> None:
    extra = extra_torque(small, [edit_of("link_com", small_compiled, {"x": 0.02}, 1)])
    np.testing.assert_allclose(extra, [-0.02 * MASS[1] * G] * 2, atol=SAG)


@pytest.mark.parametrize(("name", "which"), [("link_inertia", 1), ("rotor_inertia", 1)])
def test_inertia_is_felt_in_acceleration_only(
    small: Robot, small_compiled: CompiledRobot, name: str, which: int
) -> None:
    np.testing.assert_allclose(
        extra_torque(small, [edit_of(name, small_compiled, {"change": 0.5}, which)]), 0, atol=1e-6
    )
    changed = compile_robot(small, [edit_of(name, small_compiled, {"change": 0.5}, which)]).model
    old = small_compiled.model
    if name == "rotor_inertia":
        dof = small_compiled.at.q_dof[1]
        np.testing.assert_allclose(changed.dof_armature[dof], 1.5 * old.dof_armature[dof])
    else:
        body = old.body("fore").id
        np.testing.assert_allclose(changed.body_inertia[body], 1.5 * old.body_inertia[body])


def test_joint_zero(small_compiled: CompiledRobot) -> None:
    effect = CATALOGUE["joint_zero"]
    place = effect.places(small_compiled)[1]
    q = np.ones((3, 2))
    error = effect.encoder_error(place, {"offset": 1e-3}, q, q)
    np.testing.assert_array_equal(error, np.tile([0, 1e-3], (3, 1)))


def test_link_length(small: Robot, small_compiled: CompiledRobot) -> None:
    longer = rest(small, [edit_of("link_length", small_compiled, {"longer": 1e-3})], LEVEL)
    plain = rest(small, [], LEVEL)
    np.testing.assert_allclose(longer.reflectors - plain.reflectors, np.tile([0, 0, 1e-3], (3, 1)), atol=1e-6)


def test_dress_pack(small: Robot, small_compiled: CompiledRobot) -> None:
    q = np.array([0.5, -0.4])
    edit = edit_of("dress_pack", small_compiled, {"stiffness": 80.0, "neutral": 0.2}, 1)
    extra = rest(small, [edit], q).torque - rest(small, [], q).torque
    np.testing.assert_allclose(extra, [0, 80 * (-0.4 - 0.2)], atol=SAG)


def test_torque_offset(small: Robot, small_compiled: CompiledRobot) -> None:
    """A torque that helps the motor takes as much off its own."""
    extra = extra_torque(small, [edit_of("torque_offset", small_compiled, {"torque": 30.0}, 1)])
    np.testing.assert_allclose(extra, [0, -30], atol=SAG)
    beyond = np.array([0.0, 1.9])
    found = rest(small, [edit_of("torque_offset", small_compiled, {"torque": 30.0}, 1)], beyond)
    np.testing.assert_allclose(found.torque - rest(small, [], beyond).torque, [0, -30], atol=SAG)


def test_thermal_growth(hh150: Robot, hh150_compiled: CompiledRobot) -> None:
    """The arm grows by alpha L dT; the foot, on which it stands, does not."""
    alpha, air, gear = 1.15e-5, 5.0, 25.0
    conditions = Conditions(np.full(6, 293.15 + gear), np.full(6, 293.15), ambient_k=293.15 + air)
    edit = edit_of("thermal_growth", hh150_compiled, {"expansion": alpha, "soak": 0.25}, conditions=conditions)
    q = np.zeros(6)
    strain = alpha * (0.75 * air + 0.25 * gear)
    warm, cold = rest(hh150, [edit], q), rest(hh150, [], q)
    foot = hh150_compiled.model.body("column").pos
    np.testing.assert_allclose(warm.reflectors - cold.reflectors, strain * (cold.reflectors - foot), atol=1e-6)
    assert strain * 2 > 2e-4


def test_inertia_in_motion(small: Robot, small_compiled: CompiledRobot) -> None:
    """While all speeds are constant, rotor inertia does not count; while they rise, the servo pays J dq/dt."""
    edit = edit_of("rotor_inertia", small_compiled, {"change": 0.5}, 0)
    start, speed = np.zeros(2), np.array([0.2, 0.0])
    heavy, plain = sweep(small, [edit], start, speed, 100), sweep(small, [], start, speed, 100)
    impulse = np.sum(heavy.motor_torque[:, 0] - plain.motor_torque[:, 0]) * 1e-3
    np.testing.assert_allclose(impulse, 0.5 * 40 * 0.2, rtol=0.05)  # the servo overshoots a little


def test_floor_tilt(small: Robot, small_compiled: CompiledRobot) -> None:
    model = compile_robot(small, [edit_of("floor_tilt", small_compiled, {"x": 0.01})]).model
    np.testing.assert_allclose(model.opt.gravity, 9.81 * np.array([0.01, 0, -1]), atol=1e-3)
    np.testing.assert_allclose(np.linalg.norm(model.opt.gravity), 9.81)
