"""Fitted errors of readings: as a replay applies them, as simulated instruments have them, and as a fit finds them."""

from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from bench.diagnose.replay.fitted import figures_with, fitted_world, torque_constant_of
from bench.diagnose.replay.nuisances import Nuisance, nuisances_of
from bench.diagnose.replay.perfect_instruments import ideal_reading
from bench.diagnose.replay.quantities import Quantity
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.fitted import NOTHING
from bench.robot.folder import load_robot, robot_names
from bench.simulate.instruments import Instruments, SystematicErrors
from tests.effects.rest import some_trace
from tests.small_robot import FIGURES, write_small_robot

READINGS = {
    "current_gain": {"hinge_a": 0.03, "hinge_b": -0.02},
    "current_offset_a": {"hinge_b": 0.4},
    "torque_gain": {"hinge_b": 0.05},
    "torque_offset_nm": {"hinge_a": -3.0},
    "link_encoder_zero_rad": {"hinge_a": 2e-4},
    "tracker_shift_m": [1e-4, -2e-4, 3e-4],
    "tracker_turn_rad": [1e-4, 2e-4, -3e-4],
    "tracker_drift_m_per_h": [1e-5, -2e-5, 5e-6],
    "nest_m": {"nest_2": [2e-5, 0.0, -1e-5]},
    "force_gain": 0.01,
    "force_tilt_rad": [4e-4, -2e-4, 3e-4],
}
SMALL_ANGLE = 5e-4  # [rad], the largest above; where two of them meet, replay and instruments differ by their product
EVERY_KIND = ("current", "tau_motor", "q_link", "reflector", "force", "gas_temperature")


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> CompiledRobot:
    folder = write_small_robot(tmp_path_factory.mktemp("fitted"))
    instruments = FIGURES["instruments"] | {"torque": {"sigma_nm": 1.0}, "link_encoder": {"joints": ["hinge_a"]}}
    content = FIGURES | {"instruments": instruments, "fitted": {"readings": READINGS}}
    (folder / "figures.yaml").write_text(yaml.safe_dump(content))
    return compile_robot(load_robot(folder))


def without(compiled: CompiledRobot) -> CompiledRobot:
    robot = compiled.robot
    return replace(compiled, robot=replace(robot, figures=robot.figures.model_copy(update={"fitted": NOTHING})))


def fitted_alone(compiled: CompiledRobot) -> SystematicErrors:
    """Return the systematic errors of the figures without what a draw adds to them."""
    with_them = Instruments(compiled, np.random.default_rng(1)).errors
    drawn = Instruments(without(compiled), np.random.default_rng(1)).errors
    names = (field.name for field in fields(SystematicErrors))
    return SystematicErrors(**{name: getattr(with_them, name) - getattr(drawn, name) for name in names})


def test_draws_scatter_about_what_was_fitted(compiled: CompiledRobot) -> None:
    errors = fitted_alone(compiled)
    np.testing.assert_allclose(errors.current_gain, [0.03, -0.02])
    np.testing.assert_allclose(errors.current_offset, [0.0, 0.4], atol=1e-15)
    np.testing.assert_allclose(errors.link_encoder_offset, [2e-4, 0.0], atol=1e-15)
    np.testing.assert_allclose(errors.placement[1], [2e-5, 0.0, -1e-5], atol=1e-15)
    np.testing.assert_allclose(errors.frame_drift, [1e-5, -2e-5, 5e-6])
    perfect = Instruments(compiled, None).errors
    assert all(not np.any(getattr(perfect, field.name)) for field in fields(SystematicErrors))


def test_a_reflector_that_is_carried_round_keeps_its_fitted_place(compiled: CompiledRobot) -> None:
    one, other = (Instruments(robot, np.random.default_rng(2)) for robot in (compiled, without(compiled)))
    one.move_reflector()
    other.move_reflector()
    expected = [[0.0] * 3, [2e-5, 0.0, -1e-5], [0.0] * 3]
    np.testing.assert_allclose(one.errors.placement - other.errors.placement, expected, atol=1e-15)


def test_a_replay_reads_what_the_simulated_instruments_read(compiled: CompiledRobot, rng: np.random.Generator) -> None:
    """Two ways through the same figures; they differ where small angles meet."""
    _, trace = some_trace(compiled.robot, rng)
    instruments = Instruments(without(compiled), rng)
    instruments.errors = fitted_alone(compiled)
    seen = instruments.systematic(trace)
    ideal = ideal_reading(compiled, trace)
    ((nuisance, value),) = fitted_world(compiled).deviations.items()
    assert nuisance.on_reading
    found = nuisance.on_reading(value, ideal)
    for name in ("current", "torque", "force", "moment", "reflectors"):
        expected, plain = seen[name], getattr(ideal, name)
        size = float(np.max(np.abs(plain)))
        np.testing.assert_allclose(getattr(found, name), expected, rtol=0, atol=3 * SMALL_ANGLE**2 * size, err_msg=name)
        assert np.max(np.abs(expected - plain)) > 1e-4 * size
    np.testing.assert_allclose(found.q_link[:, 0], seen["q_link"][:, 0], atol=1e-12)


@pytest.mark.parametrize("name", [*robot_names(), "small"])
def test_every_error_of_an_instrument_has_its_place_in_the_figures(
    name: str, compiled: CompiledRobot, tmp_path: Path
) -> None:
    """A deviation that nobody gave a place would be lost when a fit is handed over; none shares its place."""
    robot = without(compiled) if name == "small" else compile_robot(load_robot(name))
    counts = {"reflector": len(robot.robot.figures.reflectors), "force": 1, "gas_temperature": 1}
    quantities = [
        Quantity(f"{kind}_{i}", kind, "", i) for kind in EVERY_KIND for i in range(counts.get(kind, robot.n_joints))
    ]
    nuisances = [n for n in nuisances_of(robot, tuple(quantities)) if not n.edit]
    assert len(nuisances) > 2 * robot.n_joints
    found = set()
    for nuisance in nuisances:
        readings, weights, left = figures_with(robot, {nuisance: 0.01})
        assert left == ()
        found.add((readings.model_dump_json(), weights.model_dump_json()))
    nothing = (NOTHING.readings.model_dump_json(), NOTHING.weights.model_dump_json())
    assert nothing not in found
    assert len(found) == len(nuisances)


def test_the_constant_of_a_slide_is_a_force_by_current(compiled: CompiledRobot) -> None:
    """The table of a gantry said 83 Nm/A of a drive that pushes 83 N/A."""
    for robot, joint, unit in ((compile_robot(load_robot("emps")), "carriage", "N/A"), (compiled, "hinge_a", "Nm/A")):
        found = torque_constant_of(robot, Nuisance(f"torque constant of {joint}", "", 0.02, on_reading=lambda x, r: r))
        assert found is not None
        assert found[1] == unit
