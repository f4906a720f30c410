"""What holds for every entry: null values change nothing, typical ones run, and the edited model can be saved."""

from dataclasses import dataclass, fields
from functools import cached_property

import mujoco
import numpy as np
import pytest

from bench.effects.conditions import Conditions
from bench.effects.effect import Effect
from bench.effects.unlisted import unlisted
from bench.robot.compiled import CompiledRobot, compile_robot, compile_spec, read_spec
from bench.robot.edits import friction_on
from bench.robot.folder import Robot
from bench.simulate.instruments import Reading
from bench.simulate.payload import bolt_on
from bench.simulate.plant import Plant
from bench.simulate.trace import Trace
from tests.effects.rest import CATALOGUE, PERIOD, perfect_reading, places_of, some_trace, typical

EVERYTHING = {**CATALOGUE, **unlisted()}
EDITED = [name for name, effect in EVERYTHING.items() if type(effect).edit is not Effect.edit]
PAYLOAD = 12.0  # [kg]
SETTLED = 1e-6  # [rad/s]; of a robot that was put at rest
SIDES = ("as-model", "none")  # of friction
WARM = 15.0  # [K]
LATER = 3600.0  # [s], after all that sets in


def warm(n: int) -> Conditions:
    gears, windings = np.full(n, 293.15 + WARM), np.full(n, 293.15 + 2 * WARM)
    return Conditions(gears, windings, payload_kg=PAYLOAD, time_s=LATER)


def same_model(left: mujoco.MjModel, right: mujoco.MjModel) -> bool:
    def numbers(model: mujoco.MjModel) -> dict[str, np.ndarray]:
        everything = {name: getattr(model, name) for name in dir(model) if not name.startswith("_")}
        return {name: value for name, value in everything.items() if isinstance(value, np.ndarray)}

    first, second = numbers(left), numbers(right)
    return all(np.array_equal(first[name], second[name]) for name in first)


@dataclass(frozen=True, eq=False)
class Sound:
    """A robot in which nothing acts, made once for all that may act in it; nothing of it is changed."""

    robot: Robot

    @cached_property
    def compiled(self) -> CompiledRobot:
        return compile_robot(self.robot)

    @cached_property
    def loaded(self) -> CompiledRobot:
        return compile_robot(self.robot, [bolt_on(PAYLOAD)])

    @cached_property
    def loaded_with(self) -> dict[str, CompiledRobot]:
        """The robot loaded, by the side that its friction is on."""
        return {side: compile_robot(self.robot, [friction_on(side), bolt_on(PAYLOAD)]) for side in SIDES}

    @cached_property
    def seen(self) -> tuple[Trace, Reading]:
        """Some motion, and what perfect instruments show of it."""
        plant, trace = some_trace(self.robot, np.random.default_rng(20261121))
        return trace, perfect_reading(plant.compiled, trace)


@pytest.fixture(scope="module")
def sound(small: Robot, hh150: Robot) -> dict[str, Sound]:
    return {"small": Sound(small), "hh150": Sound(hh150)}


@pytest.fixture(params=["small", "hh150"])
def one(request: pytest.FixtureRequest, sound: dict[str, Sound]) -> Sound:
    return sound[request.param]


@pytest.fixture
def robot(one: Sound) -> Robot:
    return one.robot


@pytest.fixture
def compiled(one: Sound) -> CompiledRobot:
    return one.compiled


@pytest.mark.parametrize("name", EVERYTHING)
def test_null_changes_nothing(name: str, one: Sound) -> None:
    effect, robot, compiled = EVERYTHING[name], one.robot, one.compiled
    trace, reading = one.seen
    for place in places_of(effect, compiled)[:2]:
        values, conditions = effect.complete({}), warm(compiled.n_joints)
        edit = effect.edit(place, values, conditions)
        if edit is not None:
            assert same_model(compile_robot(robot, [bolt_on(PAYLOAD), edit]).model, one.loaded.model)
        error = effect.encoder_error(place, values, trace.q, trace.q_velocity)
        assert error is None or not np.any(error)
        assert effect.lateness(place, values) is None
        assert all(effect.log_error(place, values, run) is None for run in place.runs)
        seen = effect.distort(place, values, reading, trace, conditions)
        for field in fields(reading):
            np.testing.assert_array_equal(getattr(seen, field.name), getattr(reading, field.name))


@pytest.mark.parametrize("name", EVERYTHING)
def test_typical_values_do_something(name: str, one: Sound) -> None:
    """At least one of its methods says that something changes."""
    effect, compiled = EVERYTHING[name], one.compiled
    trace, reading = one.seen
    for place in places_of(effect, compiled)[:1]:
        values, conditions = effect.complete(typical(effect, compiled, place)), warm(compiled.n_joints)
        seen = effect.distort(place, values, reading, trace, conditions)
        assert (
            effect.edit(place, values, conditions) is not None
            or effect.encoder_error(place, values, trace.q, trace.q_velocity) is not None
            or effect.lateness(place, values) is not None
            or any(effect.log_error(place, values, run) is not None for run in place.runs)
            or any(
                not np.array_equal(getattr(seen, f.name), getattr(reading, f.name), equal_nan=True)
                for f in fields(reading)
            )
        )


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("name", EDITED)
def test_stays_where_it_was_put(name: str, side: str, one: Sound) -> None:
    """With an effect of typical size the robot has a rest, and stays there in time, everywhere where it can act."""
    robot, compiled, base = one.robot, one.loaded_with[side], [friction_on(side), bolt_on(PAYLOAD)]
    q = np.full(compiled.n_joints, 0.3)
    effect = EVERYTHING[name]
    for place in places_of(effect, compiled):
        edit = effect.edit(place, effect.complete(typical(effect, compiled, place)), warm(compiled.n_joints))
        assert edit is not None
        plant = Plant(robot, [*base, edit])
        plant.reset(q)
        trace = plant.advance(np.tile(q, (25, 1)), np.zeros((25, 6)), PERIOD)
        assert np.max(np.abs(trace.theta_velocity)) < SETTLED, str(place)
        assert np.max(np.abs(trace.q - q)) < SETTLED, str(place)


@pytest.mark.parametrize("name", EDITED)
def test_moves_without_ringing_up(name: str, robot: Robot, compiled: CompiledRobot) -> None:
    effect = EVERYTHING[name]
    start = np.full(compiled.n_joints, 0.2)
    commands = start + 0.1 * np.sin(np.arange(150) * PERIOD * 2)[:, None]
    for place in places_of(effect, compiled)[:1]:
        values = effect.complete(
            {p.name: p.null if p.is_shape else p.null + p.high for p in effect.parameters_at(compiled, place)}
        )
        edit = effect.edit(place, values, warm(compiled.n_joints))
        assert edit is not None
        plant = Plant(robot, [bolt_on(PAYLOAD), edit])
        plant.reset(start)
        trace = plant.advance(commands, np.zeros((150, 6)), PERIOD)
        assert np.max(np.abs(trace.theta - commands[0])) < 0.3
        assert np.max(np.abs(trace.theta_velocity)) < 1.0


@pytest.mark.parametrize("name", EDITED)
def test_edited_model_saves_and_loads(name: str, robot: Robot, compiled: CompiledRobot) -> None:
    effect = EVERYTHING[name]
    for place in places_of(effect, compiled)[-1:]:
        edit = effect.edit(place, effect.complete(typical(effect, compiled, place)), warm(compiled.n_joints))
        assert edit is not None
        spec = read_spec(robot)
        model = compile_spec(spec, robot, [bolt_on(PAYLOAD), edit]).model
        again = mujoco.MjModel.from_xml_string(spec.to_xml())
        forces = []
        for either in (model, again):
            data = mujoco.MjData(either)
            data.qpos[:] = 0.01
            data.qvel[:] = 0.01
            mujoco.mj_forward(either, data)
            forces.append(data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias)
        assert again.nplugin == model.nplugin
        np.testing.assert_allclose(forces[1], forces[0], rtol=1e-4, atol=0.1)  # numbers are saved with six digits


@pytest.mark.parametrize("name", EVERYTHING)
def test_entry_is_complete(name: str) -> None:
    effect = EVERYTHING[name]
    assert effect.name == name
    assert effect.title
    assert len(effect.physics) > 40
    assert len(effect.source) > 5
    names = [parameter.name for parameter in effect.parameters]
    assert len(set(names)) == len(names)
    assert not effect.parameters[0].is_shape
    for parameter in effect.parameters:
        assert parameter.low < parameter.high
        assert parameter.is_shape or parameter.low > 0
        if parameter.is_shape:
            assert parameter.low <= parameter.null <= parameter.high
