"""What the catalogue of effects takes for granted: where they can act, and how large they may be."""

import ast
import inspect
from types import ModuleType, SimpleNamespace
from typing import Any

import mujoco
import numpy as np
import pytest

from bench.effects import learned_torques, masses, payloads
from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.effect import Place
from bench.effects.learned import values_at
from bench.effects.recorded import Recorded, RecordedRun
from bench.robot.compiled import compile_robot, read_spec
from bench.robot.folder import Robot, load_robot
from bench.robot.plugins import number_of
from tests.diagnose.assumed.registry import needs
from tests.diagnose.sweeps import nominal

HEAVY = 150.0  # [kg], rated load of an arm
STEEL = 7850.0  # [kg/m^3]


def imported_anew(module: ModuleType) -> Any:
    """Return a module as its source would be imported with the numbers that it has now: ranges are made on import."""
    tree = ast.parse(inspect.getsource(module))
    names: dict[str, Any] = {"__name__": module.__name__}
    for node in tree.body:
        exec(compile(ast.Module([node], []), module.__name__, "exec"), names)
        if isinstance(node, ast.Assign):
            names |= {one.id: vars(module)[one.id] for one in ast.walk(node.targets[0]) if isinstance(one, ast.Name)}
    return SimpleNamespace(**names)


def payload_of(name: str) -> Any:
    """Return a parameter of an unstated payload, whose range is a part of the largest payload."""
    return next(one for one in imported_anew(payloads).UnstatedPayload.parameters if one.name == name)


@needs("effects.payloads.LIGHT")
def a_payload_that_nobody_stated_is_at_first_a_gripper() -> None:
    assert 12.0 < HEAVY * payload_of("mass").typical < 18.0  # [kg]


@needs("effects.payloads.COMPACT_M")
def the_most_compact_payload_is_a_steel_cube_as_heavy_as_a_gripper() -> None:
    side = (15.0 / STEEL) ** (1 / 3)
    gyration = np.sqrt(2 * payload_of("second_moment_x").low / payload_of("mass").low)
    assert gyration == pytest.approx(side / np.sqrt(6), rel=0.25)


@needs("effects.payloads.BULKY_M")
def the_bulkiest_payload_is_a_side_panel_of_a_car() -> None:
    gyration = np.sqrt(2 * payload_of("second_moment_x").high / payload_of("mass").high)
    assert gyration == pytest.approx(
        np.hypot(2.0, 1.0) / np.sqrt(12), rel=0.25
    )  # two metres by one, held in its middle


@needs("effects.gas.SEAL_TRAVEL")
def lips_of_a_seal_shear_by_hundredths_of_a_millimetre() -> None:
    # after 0.03 mm of a stroke they still hold, after 0.08 mm they slide
    seal, spec, robot = catalogue()["seal_friction"], read_spec(load_robot("hh150")), load_robot("hh150")
    change = seal.edit(Place("robot"), {"share": 0.05}, Conditions.reference(6))
    assert change
    before = {actuator.name for actuator in spec.actuators}
    change(spec, robot)
    (cylinder,) = (name for name in before if name == robot.figures.counterbalance.actuator)  # type: ignore[union-attr]
    stiffness = number_of(spec, cylinder, "seal_presliding")
    compiled = nominal()
    data = mujoco.MjData(compiled.model)
    mujoco.mj_forward(compiled.model, data)
    level = 0.05 * float(np.abs(data.actuator(cylinder).force[0]))
    assert stiffness * 3e-5 < level < stiffness * 8e-5


@needs("effects.learned_torques.STEEPEST")
def a_gear_error_may_double_a_stiffness_and_not_quadruple_it() -> None:
    compiled = nominal()
    stiffness, nodes = float(compiled.stiffness[1]), np.linspace(-1000.0, 1000.0, 9)

    def steepest(times: float) -> float:
        """Return how much steeper an element becomes, at most, that is to become so much steeper at zero load."""
        error = np.clip(nodes, -250, 250) / stiffness * (1 - 1 / times)
        effect = learned_torques.LearnedTorsion(values_at(nodes, "Nm", "rad", 1e-3), nodes)
        values = {p.name: float(value) for p, value in zip(effect.parameters, error, strict=True)}
        laws: list[Any] = []
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(learned_torques, "add_torque_table", lambda spec, name, law, **_: laws.append(law))
            change = effect.edit(catalogue()["softening"].places(compiled)[1], values, Conditions.reference(6))
            assert change
            change(read_spec(compiled.robot), compiled.robot)
        table = np.array(laws[0].forward)
        twist = np.linspace(laws[0].angle_min, laws[0].angle_max, len(table))
        return float(1 - np.min(np.diff(table) / np.diff(twist)) / stiffness)

    assert steepest(2.0) == pytest.approx(2.0, rel=0.1)
    assert steepest(4.0) < 3.5


@needs("effects.places.SHORT")
def a_tube_of_a_forearm_has_a_length_and_an_adapter_has_none() -> None:
    robot, tube = load_robot("kr300"), "forearm_tube"

    def has_length(length: float) -> bool:
        def stretch(spec: mujoco.MjSpec, _: Robot) -> None:
            body = spec.body(tube)
            body.pos = np.array(body.pos) * length / np.linalg.norm(body.pos)

        compiled = compile_robot(robot, [stretch])
        return tube in {place.name for place in catalogue()["link_length"].places(compiled)}

    assert has_length(0.12)
    assert not has_length(0.08)


@needs("effects.recorded.BREAK")
def somebody_may_have_laid_hands_on_the_robot_in_a_break() -> None:
    # with a break of an hour, a pause of five minutes is the way to the next run, and ten minutes are a break
    pauses = [3600.0, 300.0, 600.0]
    starts = np.concatenate([[0.0], np.cumsum(np.array(pauses) + 60.0)])
    runs = tuple(
        RecordedRun(f"run {i}", float(start), float(start) + 60.0, frozenset(), True, False, 0.0)
        for i, start in enumerate(starts)
    )
    assert [run.name for run in Recorded(runs).after_breaks] == ["run 1", "run 3"]


@needs("effects.recorded.LATEST_DRIVE_S")
def a_drive_may_be_late_by_three_cycles_of_its_bus_and_not_by_eight() -> None:
    cycle = 0.004  # [s]
    (delay,) = catalogue()["channel_delay"].parameters_at(nominal(), Place("drive", 1, "drive 2"))
    assert 3 * cycle < delay.high < 8 * cycle


@needs("effects.masses.SLOWEST_SPIN")
def the_rotors_of_a_heavy_arm_are_found_where_a_model_has_placeholders() -> None:
    """Axis 3 of the KR300 has the heaviest rotor for its torque that we know; half as much again would be no motor."""

    def with_placeholders(spec: mujoco.MjSpec, robot: Robot) -> None:
        for drive in robot.figures.drives:
            spec.joint(drive.rotor).armature = 1.0

    robot = load_robot("kr300")
    true = compile_robot(robot)
    rotors = true.model.dof_armature[true.at.q_dof]
    stated, effect = compile_robot(robot, [with_placeholders]), masses.RotorInertia()
    found = [1.0 + effect.parameters_at(stated, place)[0].high for place in effect.places(stated)]
    assert np.all(found >= 0.95 * rotors)
    assert found[2] < 1.5 * rotors[2]
