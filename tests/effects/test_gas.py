"""Effects of gas and cylinder: the pull and its moment against the laws in NumPy."""

from dataclasses import replace

import numpy as np
import pytest

from bench.actuators.laws import GasSpring
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import Robot
from bench.robot.plugins import configure
from bench.simulate.plant import Plant
from tests.effects.rest import CATALOGUE, PERIOD, edit_of, rest

POSES = np.array([[-0.8, 0.2], [0.3, -0.5], [1.2, 0.4]])
EXACT = 1e-9  # relative: same law in C and in NumPy


def pull_and_length(robot: Robot, edits: list, q: np.ndarray) -> tuple[float, float]:
    found = rest(robot, edits, q)
    data, at = found.equilibrium.data, found.equilibrium.compiled.at
    return -float(data.actuator_force[at.counterbalance]), float(data.ten_length[at.counterbalance_tendon])


@pytest.fixture
def law(small_compiled: CompiledRobot) -> GasSpring:
    balance = small_compiled.counterbalance
    assert balance
    return GasSpring(constant=balance.gas_constant, critical_length=balance.critical_length)


def test_exponent(small: Robot, small_compiled: CompiledRobot, law: GasSpring) -> None:
    balance = small_compiled.counterbalance
    assert balance
    reference = float(balance.length(0.0))
    bent = replace(law, exponent=1.3, reference_length=reference)
    for q in POSES:
        pull, length = pull_and_length(small, [edit_of("polytropic_exponent", small_compiled, {"exponent": 1.3})], q)
        np.testing.assert_allclose(pull, bent.gas_force(length), rtol=EXACT)
        assert (pull > law.gas_force(length)) == (length > reference)


@pytest.mark.parametrize(
    ("name", "values", "factor"),
    [("gas_loss", {"lost": 0.2}, 0.8), ("gas_temperature", {"offset": -10.0}, 1 - 10 / 293.15)],
)
def test_amount(
    small: Robot, small_compiled: CompiledRobot, law: GasSpring, name: str, values: dict[str, float], factor: float
) -> None:
    for q in POSES:
        pull, length = pull_and_length(small, [edit_of(name, small_compiled, values)], q)
        np.testing.assert_allclose(pull, factor * law.gas_force(length), rtol=EXACT)


def test_loss_and_temperature_together(small: Robot, small_compiled: CompiledRobot, law: GasSpring) -> None:
    edits = [
        edit_of("gas_loss", small_compiled, {"lost": 0.1}),
        edit_of("gas_temperature", small_compiled, {"offset": 29.315}),
    ]
    pull, length = pull_and_length(small, edits, POSES[1])
    np.testing.assert_allclose(pull, 0.9 * 1.1 * law.gas_force(length), rtol=EXACT)


def test_seals_rub_with_the_pressure_and_hold(small: Robot, small_compiled: CompiledRobot, law: GasSpring) -> None:
    """Out and back, the rod force differs by twice the share; the travel to slip is below a tenth of a millimetre."""
    share = 0.05
    compiled = compile_robot(small, [edit_of("seal_friction", small_compiled, {"share": share})])
    found = rest(small, [edit_of("seal_friction", small_compiled, {"share": share})], np.array([0.4, 0.0]))
    equilibrium, at = found.equilibrium, compiled.at
    forces = []
    for a in (0.4, 0.6, 0.8, 0.6):
        equilibrium.solve(np.array([a, 0.0]), np.zeros(6))
        data = equilibrium.data
        length = data.ten_length[at.counterbalance_tendon]
        forces.append((-data.actuator_force[at.counterbalance], float(law.gas_force(length)), length))
    for (pull, gas, _), sign in zip(forces[1:], (1, 1, -1), strict=True):
        np.testing.assert_allclose(pull, gas * (1 + sign * share), rtol=1e-6)
    balance = compiled.counterbalance
    assert balance
    pulls, gases, lengths = (np.array(column) for column in zip(*forces, strict=True))
    np.testing.assert_allclose(balance.gas_force(pulls, lengths), gases, rtol=1e-9)  # what a gauge reads
    gas = law.gas_force(balance.length(0.8))
    presliding = share * float(law.gas_force(balance.length(0.0))) / 5e-5
    assert share * gas / presliding < 1e-4


def test_relaxation(small: Robot, small_compiled: CompiledRobot, law: GasSpring) -> None:
    """A fast stroke heats or cools the gas; the plant follows the law along the same lengths."""
    plant = Plant(small, [edit_of("thermal_relaxation", small_compiled, {"gamma_excess": 0.4, "relaxation_time": 5})])
    plant.reset(np.array([0.0, 0.0]))
    ramp = np.clip(np.arange(1, 751) / 250, 0, 1)[:, None] * np.array([1.2, 0.0])
    trace = plant.advance(ramp, np.zeros((750, 6)), PERIOD)
    lengths = trace.counterbalance_length
    hot = replace(law, heat_capacity_ratio=1.4, relaxation_time=5.0)
    rise = hot.temperature_rise(lengths, plant.timestep)
    np.testing.assert_allclose(trace.counterbalance_force, hot.gas_force(lengths, rise), rtol=1e-6)
    np.testing.assert_array_equal(trace.gas_force, trace.counterbalance_force)
    assert abs(rise[1000]) > 1.2 * abs(rise[-1]) > 0.003


@pytest.mark.parametrize("name", ["a", "b", "h"])
def test_anchor_moves_one_figure(hh150: Robot, hh150_compiled: CompiledRobot, name: str) -> None:
    """Of a, b, h of Eqs. (9) and (10) the one that is named grows by its value, the others stay."""
    step = 4e-3

    def figures(compiled: CompiledRobot) -> np.ndarray:
        balance = compiled.counterbalance
        assert balance
        # moving anchor straight below the joint at zero, so the dead centre is the fixed anchor's angle to the vertical
        a, h = balance.rho * np.sin(balance.dead_centre), balance.rho * np.cos(balance.dead_centre)
        return np.array([abs(a), balance.b, h])

    changed = compile_robot(hh150, [edit_of("anchor", hh150_compiled, {name: step})])
    expected = step * (np.array(["a", "b", "h"]) == name)
    np.testing.assert_allclose(figures(changed) - figures(hh150_compiled), expected, atol=1e-12)


def test_gas_that_the_model_leaves_out(small: Robot, law: GasSpring) -> None:
    def empty(spec, robot):
        configure(spec, robot.figures.counterbalance.actuator, gas_amount=0.0)

    without = compile_robot(small, [empty])
    effect = CATALOGUE["counterbalance_gas"]
    (place,) = effect.places(without)
    assert not CATALOGUE["gas_loss"].places(without)
    edit = edit_of("counterbalance_gas", without, {"gas_amount": 0.7})
    pull, length = pull_and_length(small, [empty, edit], POSES[0])
    np.testing.assert_allclose(pull, 0.7 * law.gas_force(length), rtol=EXACT)
    assert place.kind == "robot"
