"""Effects of the transmission: torsion at rest against closed forms."""

import numpy as np
import pytest

from bench.effects.conditions import Conditions
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.edits import proportional_servo
from bench.robot.folder import Robot
from tests.effects.rest import CATALOGUE, edit_of, rest
from tests.small_robot import K

Q = np.array([0.3, 0.2])
LOADS = [np.array([0, 0, force, 0, 0, 0]) for force in (-250.0, -50.0, 100.0, 250.0)]
RIGHT = 1e-9  # [rad]


@pytest.mark.parametrize("load", LOADS)
def test_compliance(small: Robot, small_compiled: CompiledRobot, load: np.ndarray) -> None:
    found = rest(small, [edit_of("joint_compliance", small_compiled, {"change": 0.25}, 1)], Q, load)
    np.testing.assert_allclose(Q - found.theta, found.torque * [1, 1.25] / K, atol=RIGHT)


@pytest.mark.parametrize("load", LOADS)
def test_softening(small: Robot, small_compiled: CompiledRobot, load: np.ndarray) -> None:
    softness, knee = 0.6, 0.02
    edit = edit_of("softening", small_compiled, {"softness": softness, "knee": knee}, 1)
    found = rest(small, [edit], Q, load)
    torsion, bend = (Q - found.theta)[1], knee * 9000 / K[1]
    expected = K[1] * (torsion - softness * bend * np.tanh(torsion / bend))
    np.testing.assert_allclose(found.torque[1], expected, atol=1e-3 * softness * K[1] * bend)


@pytest.mark.parametrize("servo", ["integral", "proportional"])
@pytest.mark.parametrize("load", LOADS)
def test_backlash(small: Robot, small_compiled: CompiledRobot, load: np.ndarray, servo: str) -> None:
    gap = 4e-4
    servos = [proportional_servo] if servo == "proportional" else []
    found = rest(small, [edit_of("backlash", small_compiled, {"gap": gap}, 1), *servos], Q, load)
    data, at = found.equilibrium.data, found.equilibrium.compiled.at
    torsion = data.qpos[at.q[1]] - found.theta[1]
    np.testing.assert_allclose(torsion, found.torque[1] / K[1] + np.sign(found.torque[1]) * gap / 2, atol=RIGHT)


def test_backlash_is_lost_motion(small: Robot, small_compiled: CompiledRobot) -> None:
    """Where the torque on joint 2 changes sign, the link falls through the whole gap."""
    gap = 4e-4
    edit = edit_of("backlash", small_compiled, {"gap": gap}, 1)
    up, down = (rest(small, [edit], Q, load).theta[1] for load in (LOADS[3], LOADS[0]))
    plain_up, plain_down = (rest(small, [], Q, load).theta[1] for load in (LOADS[3], LOADS[0]))
    np.testing.assert_allclose((up - down) - (plain_up - plain_down), -gap, rtol=0.01)  # up is towards -


def test_hysteresis(small: Robot, small_compiled: CompiledRobot) -> None:
    """At one load, reached from above and from below, torsion differs by 2 h/k."""
    level = 20.0
    edit = edit_of("hysteresis", small_compiled, {"level": level, "slip": 5e-5}, 1)
    found = rest(small, [edit], Q)
    equilibrium, theta = found.equilibrium, []
    for force in (250.0, 0.0, -250.0, 0.0):
        theta.append(equilibrium.solve(Q, np.array([0, 0, force, 0, 0, 0]))[1])
    np.testing.assert_allclose(theta[1] - theta[3], -2 * level / K[1], rtol=0.01)  # up is towards -


@pytest.mark.parametrize("cycles", [1.0, 40.0])
def test_transmission_error(small: Robot, small_compiled: CompiledRobot, cycles: float) -> None:
    """At rest the link stands at q + e(theta) - tau/k."""
    sine, cosine = 2e-4, -1e-4
    edit = edit_of("transmission_error", small_compiled, {"sin": sine, "cos": cosine, "cycles": cycles}, 1)
    for b in np.linspace(-1.5, 1.5, 7):
        q = np.array([0.3, b])
        found, plain = rest(small, [edit], q), rest(small, [], q)
        angle = cycles * found.theta[1]
        lead = sine * np.sin(angle) + cosine * np.cos(angle)
        np.testing.assert_allclose(found.theta[1] - plain.theta[1], lead, atol=3e-6)  # 1 % of e: knots and gravity


def test_wrist_coupling(hh150: Robot, hh150_compiled: CompiledRobot) -> None:
    q = np.array([0.1, 0.2, 0.3, 0.8, -0.6, 0.4])
    values = {"c54": 0.01, "c64": -0.02, "c65": 0.005}
    coupled, plain = rest(hh150, [edit_of("wrist_coupling", hh150_compiled, values)], q), rest(hh150, [], q)
    expected = np.array([0, 0, 0, 0, 0.01 * 0.8, -0.02 * 0.8 + 0.005 * -0.6])
    np.testing.assert_allclose(coupled.theta - plain.theta, expected, atol=1e-4)
    # what the fifth element carries turns the fourth motor too: virtual work
    data, at = coupled.equilibrium.data, coupled.equilibrium.compiled.at
    carried = hh150_compiled.stiffness * data.ten_length[at.element]
    np.testing.assert_allclose(coupled.torque[3], carried[3] + 0.01 * carried[4] - 0.02 * carried[5], rtol=1e-6)


def test_only_a_wrist_is_coupled(small_compiled: CompiledRobot, hh150_compiled: CompiledRobot) -> None:
    assert not CATALOGUE["wrist_coupling"].places(small_compiled)
    assert CATALOGUE["wrist_coupling"].places(hh150_compiled)


def test_a_warm_gear_gives_more(hh150: Robot, hh150_compiled: CompiledRobot) -> None:
    warm = Conditions(np.array([293.15, 303.15, *(293.15,) * 4]), np.full(6, 293.15))
    edit = edit_of("compliance_temperature", hh150_compiled, {"growth": 0.01}, 1, warm)
    factor = np.array([1, 1 / 1.1, 1, 1, 1, 1])
    np.testing.assert_allclose(compile_robot(hh150, [edit]).stiffness, factor * hh150_compiled.stiffness)
    effect, place = CATALOGUE["compliance_temperature"], CATALOGUE["compliance_temperature"].places(hh150_compiled)[1]
    assert effect.edit(place, {"growth": 0.01}, Conditions.reference(6)) is None


def test_a_parallel_axis_turns_the_next_one(hh150: Robot, hh150_compiled: CompiledRobot) -> None:
    q = np.array([0.1, 0.2, 0.3, 0.8, -0.6, 0.4])
    (place,) = CATALOGUE["axis_coupling"].places(hh150_compiled)
    assert str(place) == "joint 3"
    edit = edit_of("axis_coupling", hh150_compiled, {"ratio": 0.01})
    coupled, plain = rest(hh150, [edit], q), rest(hh150, [], q)
    expected = np.array([0, 0, 0.01 * 0.2, 0, 0, 0])
    np.testing.assert_allclose(coupled.theta - plain.theta, expected, atol=1e-4)
    data, at = coupled.equilibrium.data, coupled.equilibrium.compiled.at
    carried = hh150_compiled.stiffness * data.ten_length[at.element]
    np.testing.assert_allclose(coupled.torque[1], carried[1] + 0.01 * carried[2], rtol=1e-6)  # virtual work


def test_effects_on_one_element_add_up(small: Robot, small_compiled: CompiledRobot) -> None:
    edits = [
        edit_of("softening", small_compiled, {"softness": 0.5}, 1),
        edit_of("hysteresis", small_compiled, {"level": 10.0}, 1),
        edit_of("backlash", small_compiled, {"gap": 1e-4}, 1),
    ]
    model = compile_robot(small, edits).model
    assert model.nactuator == small_compiled.model.nactuator + 2
    rest(small, edits, Q, LOADS[0])
