"""Rest positions: against closed-form statics, the return map, and time stepping."""

from pathlib import Path

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.nominal import nominal_parameters
from bench.errors import ConvergenceError
from bench.robot.compiled import compile_robot
from bench.robot.edits import friction_on, proportional_servo
from bench.robot.folder import load_robot
from bench.simulate.equilibrium import Equilibrium
from bench.simulate.plant import Plant
from tests.small_robot import FRICTION, L_C, LINK, MASS, C, K

PERIOD = 4e-3  # [s]
BALANCE = 1e-6  # [Nm], closed form against the solver's own tolerance of 1e-9 Nm on torques near 1e3 Nm
AGREEMENT = 1e-9  # [rad], rest of a decayed vibration after 8 s


def gravity_torque(theta: np.ndarray) -> np.ndarray:
    """Torque of gravity about both hinges, in the direction of growing angle: written from the drawing."""
    a, ab = theta[0], theta[0] + theta[1]
    second = 9.81 * MASS[1] * LINK[1] / 2 * np.cos(ab)
    first = 9.81 * (MASS[0] / 2 + MASS[1]) * LINK[0] * np.sin(a)
    return np.array([first + second, second])


def cylinder_torque(a: float) -> float:
    """Restoring torque of the cylinder: from the distance of its anchors."""
    fixed = np.array([-0.02, -0.5])
    moving = -0.12 * np.array([np.sin(a), np.cos(a)])
    length = np.linalg.norm(fixed - moving)
    lever = (moving[0] * fixed[1] - moving[1] * fixed[0]) / length
    return float(C / (L_C + 0.05 - length) * lever)


@pytest.fixture
def frictionless(small_robot: Path) -> Equilibrium:
    return Equilibrium(compile_robot(load_robot(small_robot), [friction_on("none")]))


def test_torque_balance_in_closed_form(frictionless: Equilibrium, rng: np.random.Generator) -> None:
    for _ in range(50):
        q = rng.uniform([-0.9, -1.9], [1.9, 1.9])
        force = rng.uniform(-200, 200, 3)
        theta = frictionless.solve(q, np.concatenate([force, np.zeros(3)]))
        a, ab = theta[0], theta[0] + theta[1]
        fore = np.array([LINK[1] * np.cos(ab), -LINK[1] * np.sin(ab)])  # (x, z)
        hook = LINK[0] * np.array([np.sin(a), np.cos(a)]) + fore
        load = np.array([hook[1] * force[0] - hook[0] * force[2], fore[1] * force[0] - fore[0] * force[2]])
        expected = -(gravity_torque(theta) + load - np.array([cylinder_torque(a), 0.0]))
        np.testing.assert_allclose(np.array(K) * (q - theta), expected, atol=BALANCE)
        np.testing.assert_allclose(frictionless.motor_torque(), expected, atol=BALANCE)


def test_link_friction_follows_the_return_map(small_robot: Path) -> None:
    """Loading and unloading past slip: the friction is the clamped elastic trial along the path of theta."""
    compiled = compile_robot(load_robot(small_robot), [friction_on("link")])
    equilibrium = Equilibrium(compiled)
    q = np.array([0.3, 0.2])
    theta = equilibrium.solve(q, np.zeros(6))
    friction = np.zeros(2)
    for force in [*np.linspace(0, -300, 40), *np.linspace(-300, 200, 60)]:
        before, theta = theta, equilibrium.solve(q, np.array([0, 0, force, 0, 0, 0]))
        friction = np.clip(friction - compiled.link_presliding * (theta - before), *np.outer([-1, 1], FRICTION))
        np.testing.assert_allclose(equilibrium.data.actuator_force[compiled.at.link_friction], friction, atol=BALANCE)


@pytest.mark.parametrize("servo", ["integral", "proportional"])
@pytest.mark.parametrize("side", ["none", "link", "motor", "as-model"])
def test_time_stepping_comes_to_the_same_rest(small_robot: Path, side: str, servo: str) -> None:
    """Slowly loaded below slip, with every friction element stuck, both must end in the same place."""
    edits = [friction_on(side), *([proportional_servo] if servo == "proportional" else [])]
    plant = Plant(load_robot(small_robot), edits)
    q, wrench = np.array([0.3, 0.2]), np.array([0.0, 0, -20, 0, 0, 0])
    plant.reset(q)
    equilibrium = Equilibrium(plant.compiled)
    equilibrium.data.qpos[plant.compiled.at.q] = q
    equilibrium.solve(q, np.zeros(6))
    expected = equilibrium.solve(q, wrench)
    shares = np.clip(np.arange(1, 2001) / 500, 0, 1)[:, None]
    trace = plant.advance(np.tile(q, (2000, 1)), shares * wrench, PERIOD)
    np.testing.assert_allclose(trace.theta[-1], expected, atol=AGREEMENT)
    np.testing.assert_allclose(trace.motor_torque[-1], equilibrium.motor_torque(), atol=1e-3)


def test_giving_motor_slips_in_its_friction(small_robot: Path) -> None:
    """A proportional servo under load past slip: both balances hold, and motor friction follows its return map."""
    compiled = compile_robot(load_robot(small_robot), [friction_on("motor"), proportional_servo])
    equilibrium, at = Equilibrium(compiled), compiled.at
    kp = -compiled.model.actuator_biasprm[at.servo, 1]
    command = np.array([0.3, 0.2])
    equilibrium.solve(command, np.zeros(6))
    q, friction = equilibrium.data.qpos[at.q].copy(), np.zeros(2)
    for force in [*np.linspace(0, -300, 40), *np.linspace(-300, 200, 60)]:
        theta = equilibrium.solve(command, np.array([0, 0, force, 0, 0, 0]))
        before, q = q, equilibrium.data.qpos[at.q].copy()
        friction = np.clip(friction - compiled.motor_presliding * (q - before), *np.outer([-1, 1], FRICTION))
        np.testing.assert_allclose(equilibrium.data.actuator_force[at.motor_friction], friction, atol=BALANCE)
        np.testing.assert_allclose(kp * (command - q) + friction, np.array(K) * (q - theta), atol=BALANCE)


def test_says_when_there_is_no_rest(frictionless: Equilibrium) -> None:
    with pytest.raises(ConvergenceError, match="Nm are left"):
        frictionless.solve(np.array([0.3, 0.2]), np.array([0, 0, 1e9, 0, 0, 0]))


def test_a_link_that_hardly_anything_pushes_comes_through_its_gap() -> None:
    """On a foot that gives, gravity pushes a link with play by less than a thousandth of a newton metre."""
    robot = load_robot("hh150")
    nominal, effects, usual = compile_robot(robot), catalogue(), Conditions.reference(robot.n_joints)
    edits = []
    for name, values in (("backlash", {"gap": 4.4e-4}), ("base_compliance", {"compliance": 1.96e-7})):
        edit = effects[name].edit(effects[name].places(nominal)[0], values, usual)
        assert edit
        edits.append(edit)
    for parameter in nominal_parameters(nominal):
        edits.append(parameter.edit(0.5 * parameter.sigma))
    Plant(robot, edits)  # and is at rest there
