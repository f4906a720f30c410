"""A robot patched and compiled, and whether both are the same: numbers, forces, and the figures of the robot."""

from collections.abc import Iterable
from functools import partial

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.robot.compiled import CompiledRobot, SpecEdit, compile_spec
from bench.robot.folder import Robot
from bench.robot.patched import OF_FRICTION, Step, Structure
from bench.simulate.bare import bare_spec

AGREEMENT = 1e-12  # relative, of numbers and of forces: rounding of derived numbers
# Names and texts, and where they begin. A patched model keeps room behind the attributes of plugins, which are compared
# by the forces that they make, and each of its plugin instances has a name.
TEXTS = {"plugin_attr", "plugin_attradr", "names", "names_map", "paths"}


class Both:
    """One robot, patched and compiled."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.spec = bare_spec(robot)
        self.before = self.spec.to_xml()
        self.structure = Structure(robot, self.spec)
        self.nominal = self.structure.robot(())

    def patched(self, edits: Iterable[SpecEdit]) -> CompiledRobot:
        return self.structure.robot(Step(edit, partial(tuple, (edit,))) for edit in edits)

    def compiled(self, edits: Iterable[SpecEdit]) -> CompiledRobot:
        spec = self.spec.copy()
        for key in list(spec.keys):
            spec.delete(key)
        return compile_spec(spec, self.robot, edits)


def numbers_of_model(model: mujoco.MjModel) -> dict[str, NDArray[np.float64]]:
    found = {name: getattr(model, name) for name in dir(model) if not name.startswith("_")}
    numbers = {name: value for name, value in found.items() if isinstance(value, np.ndarray)}
    numbers = {name: value for name, value in numbers.items() if name not in TEXTS and not name.startswith("name_")}
    return numbers | {"gravity": model.opt.gravity, "meaninertia": np.array(model.stat.meaninertia)}


def assert_same_numbers(left: mujoco.MjModel, right: mujoco.MjModel) -> None:
    first, second = numbers_of_model(left), numbers_of_model(right)
    for name, value in second.items():
        largest = float(np.max(np.abs(value), initial=0.0))
        np.testing.assert_allclose(
            first[name].astype(float), value.astype(float), rtol=AGREEMENT, atol=AGREEMENT * largest, err_msg=name
        )


def forces(model: mujoco.MjModel) -> dict[str, NDArray[np.float64]]:
    rng = np.random.default_rng(7)
    data = mujoco.MjData(model)
    with np.errstate(all="ignore"):
        data.qpos[:] = rng.uniform(-0.4, 0.4, model.nq)
        data.qvel[:] = rng.uniform(-0.5, 0.5, model.nv)
        for _ in range(3):  # so that friction and gas remember something
            mujoco.mj_forward(model, data)
            mujoco.mj_Euler(model, data)
        data.qpos[:] = rng.uniform(-0.4, 0.4, model.nq)
        data.qvel[:] = rng.uniform(-0.5, 0.5, model.nv)
        mujoco.mj_forward(model, data)
    names = ("xpos", "xmat", "xipos", "site_xpos", "qfrc_bias", "qfrc_passive", "qfrc_actuator", "actuator_force")
    return {name: np.array(getattr(data, name)) for name in (*names, "ten_length", "plugin_state")}


def assert_same(patched: CompiledRobot, compiled: CompiledRobot) -> None:
    assert_same_numbers(patched.model, compiled.model)
    second = forces(compiled.model)
    for name, value in forces(patched.model).items():
        largest = float(np.max(np.abs(second[name]), initial=0.0))
        np.testing.assert_allclose(value, second[name], rtol=AGREEMENT, atol=10 * AGREEMENT * largest, err_msg=name)
    for name in (*OF_FRICTION, "stiffness", "play"):
        np.testing.assert_allclose(getattr(patched, name), getattr(compiled, name), rtol=AGREEMENT, err_msg=name)
    for name in vars(compiled.at):
        np.testing.assert_array_equal(getattr(patched.at, name), getattr(compiled.at, name), err_msg=name)
    assert (patched.counterbalance is None) == (compiled.counterbalance is None)
    if patched.counterbalance and compiled.counterbalance:
        np.testing.assert_allclose(
            list(vars(patched.counterbalance).values()), list(vars(compiled.counterbalance).values()), rtol=AGREEMENT
        )
