"""The state is complete: whatever copies or loads it continues with the identical motion."""

import copy

import mujoco
import numpy as np
import pytest
from mujoco import batch, rollout

from bench.actuators.laws import Friction, GasSpring, TorqueTable, config
from bench.actuators.state import ANCHORED, HELD, POSITION, state_of
from tests.actuators.slider import Array, attributes, element, mjcf, slider

GAS = GasSpring(
    constant=50,
    critical_length=2,
    heat_capacity_ratio=1.4,
    relaxation_time=0.1,
    seal_friction=0.05,
    seal_presliding=1e5,
)
FRICTION = Friction(
    coulomb=8, presliding_stiffness=1e5, static_rise=0.4, stribeck_velocity=0.02, load_coefficient=0.05, element="gear"
)
TABLE = TorqueTable(angle_min=0, angle_max=2, forward=(5, -5), backward=(7, -4), presliding_stiffness=1e5)
GEAR = 'stiffness="2000" damping="5"'
STEPS = 150
FULL = mujoco.mjtState.mjSTATE_FULLPHYSICS


@pytest.fixture
def model() -> mujoco.MjModel:
    return slider(GAS, FRICTION, TABLE, gear=GEAR)


def start(model: mujoco.MjModel) -> mujoco.MjData:
    """Return the sliders on their way, past the first steps."""
    data = mujoco.MjData(model)
    data.qpos[:] = 1, 1.02
    data.qvel[:] = 0.5, -0.2
    mujoco.mj_step(model, data, 20)
    return data


def state(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    values = np.empty(mujoco.mj_stateSize(model, FULL))
    mujoco.mj_getState(model, data, values, FULL)
    return values


def trajectory(model: mujoco.MjModel, data: mujoco.MjData) -> Array:
    """Return the full state after each step by plain stepping, which leaves `data` as it is."""
    data = copy.copy(data)
    states = []
    for _ in range(STEPS):
        mujoco.mj_step(model, data)
        states.append(state(model, data))
    return np.array(states)


def test_motion_is_alive(model: mujoco.MjModel):
    """The other tests of this file compare something: all states move, the friction sticks and slides."""
    states = trajectory(model, start(model))
    moving = np.ptp(states, axis=0) > 0
    anchored = np.flatnonzero(~moving)
    assert moving.sum() == 1 + 2 + 2 + (5 + 3 + 3) - 3  # time, qpos, qvel, plugins less their three ANCHORED
    np.testing.assert_array_equal(states[:, anchored], 1)


def test_forward_leaves_the_state_alone(model: mujoco.MjModel):
    data = start(model)
    before = state(model, data)
    mujoco.mj_forward(model, data)
    first = data.actuator_force.copy()
    for _ in range(3):
        mujoco.mj_forward(model, data)
    np.testing.assert_array_equal(data.actuator_force, first)
    np.testing.assert_array_equal(state(model, data), before)


def test_step_takes_over_what_forward_computed(model: mujoco.MjModel):
    """MuJoCo calls the plugin after it has moved qpos; the length it sees is still that of the start of the step."""
    data = start(model)
    mujoco.mj_forward(model, data)
    length, force = data.actuator_length[1], data.actuator_force[1]
    mujoco.mj_step(model, data)
    assert state_of(model, data, 1)[HELD] == force
    assert state_of(model, data, 1)[POSITION] == length
    assert data.qpos[0] != length


def test_copied_data_continue_alike(model: mujoco.MjModel):
    data = start(model)
    expected = trajectory(model, data)
    into = mujoco.MjData(model)
    mujoco.mj_copyData(into, model, data)
    np.testing.assert_array_equal(trajectory(model, into), expected)


def test_loaded_state_continues_alike(model: mujoco.MjModel):
    data = start(model)
    spec = mujoco.mjtState.mjSTATE_INTEGRATION
    values = np.empty(mujoco.mj_stateSize(model, spec))
    mujoco.mj_getState(model, data, values, spec)
    other = mujoco.MjData(model)
    mujoco.mj_setState(model, other, values, spec)
    np.testing.assert_array_equal(trajectory(model, other), trajectory(model, data))


def test_rollout_is_plain_stepping(model: mujoco.MjModel):
    starts = [start(model), mujoco.MjData(model)]
    starts[1].qpos[:] = 0.8, 0.8
    initial = np.array([state(model, data) for data in starts])
    states, _ = rollout.rollout(model, [mujoco.MjData(model), mujoco.MjData(model)], initial, nstep=STEPS)
    for result, data in zip(states, starts, strict=True):
        np.testing.assert_array_equal(result, trajectory(model, data))


@pytest.mark.parametrize("nthread", [1, 2])
def test_batch_is_plain_stepping(model: mujoco.MjModel, nthread: int):
    simulations = 5
    data = mujoco.MjData(model)
    many = batch.Batch(model, simulations, nthread=nthread)
    qpos, qvel, plugin_state = many.bind("qpos"), many.bind("qvel"), many.bind("plugin_state")
    for i in range(simulations):
        qpos[i], qvel[i] = (1, 1 + 0.01 * i), (0.1 * i, 0)
    many.step(nstep=STEPS)
    for i in range(simulations):
        mujoco.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = (1, 1 + 0.01 * i), (0.1 * i, 0)
        mujoco.mj_step(model, data, STEPS)
        np.testing.assert_array_equal(qpos[i], data.qpos)
        np.testing.assert_array_equal(plugin_state[i], data.plugin_state)


def test_models_of_a_batch_keep_their_own_parameters():
    """MuJoCo runs all models on one MjData; parameters remembered from another of them would be wrong in silence."""
    laws = [Friction(coulomb=level, presliding_stiffness=1e5) for level in (2.0, 17.25, 8.0)]
    models = [slider(law) for law in laws]
    expected = []
    for model in models:
        data = mujoco.MjData(model)
        data.qvel[0] = 1
        expected.append(trajectory(model, data))
    initial = np.zeros((len(models), mujoco.mj_stateSize(models[0], FULL)))
    initial[:, 1 + 2] = 1  # time, qpos, then qvel
    states, _ = rollout.rollout(models, mujoco.MjData(models[0]), initial, nstep=STEPS)
    np.testing.assert_array_equal(states, expected)

    many = batch.Batch(models[0], len(models), nthread=1)
    many.set_models(models)
    many.bind("qvel")[:, 0] = 1
    many.step(nstep=STEPS)
    np.testing.assert_array_equal(many.bind("qpos"), np.array(expected)[:, -1, 1:3])


def test_fresh_element_is_unstressed_where_the_first_step_finds_it(model: mujoco.MjModel):
    data = mujoco.MjData(model)
    assert not np.any(data.plugin_state)
    data.qpos[:] = 1.3
    mujoco.mj_forward(model, data)
    assert data.actuator_force[1] == 0
    data.qpos[:] = 1.2
    mujoco.mj_forward(model, data)
    assert data.actuator_force[1] == 0
    mujoco.mj_step(model, data)
    np.testing.assert_array_equal(state_of(model, data, 1), [0, 1.2, 1])


def test_reset_forgets(model: mujoco.MjModel):
    data = start(model)
    mujoco.mj_resetData(model, data)
    assert not np.any(data.plugin_state)


def test_disabled_actuator_gives_no_force(model: mujoco.MjModel):
    data = start(model)
    model.opt.disableactuator = 1  # group 0
    mujoco.mj_forward(model, data)
    np.testing.assert_array_equal(data.actuator_force, 0)


def test_shared_instance_is_the_same_as_separate_ones():
    """One plugin instance for two actuators: a number is one for both, or one for each."""
    first = Friction(coulomb=3, presliding_stiffness=1e5, load_coefficient=0.1, element="gear")
    second = Friction(coulomb=5, presliding_stiffness=1e5, load_coefficient=0.1, element="gear")
    on_x, on_w = element(first, "on_x"), element(second, "on_w").replace('joint="x"', 'joint="w"')
    separate = mujoco.MjModel.from_xml_string(mjcf(on_x + on_w, gear=GEAR))
    instance = f'<instance name="both">{attributes(first, coulomb="3 5")}</instance>'
    users = "".join(f'<plugin name="on_{joint}" joint="{joint}" instance="both"/>' for joint in "xw")
    shared = mujoco.MjModel.from_xml_string(mjcf(users, gear=GEAR, extension=instance))
    np.testing.assert_array_equal(trajectory(shared, start(shared)), trajectory(separate, start(separate)))
    data = start(shared)
    assert state_of(shared, data, 1)[POSITION] == pytest.approx(data.qpos[1], abs=1e-3)


@pytest.mark.parametrize("integrator", ["Euler", "implicit", "implicitfast", "discrete"])
def test_every_integrator_advances_from_the_start_of_the_step(integrator: str):
    text = mjcf(element(FRICTION), gear=GEAR).replace("implicitfast", integrator)
    model = mujoco.MjModel.from_xml_string(text)
    data = start(model)
    before = data.qpos[0]
    mujoco.mj_step(model, data)
    assert state_of(model, data, 0)[POSITION] == before
    assert state_of(model, data, 0)[ANCHORED] == 1


def test_saved_model_is_the_same_model(model: mujoco.MjModel):
    """Attributes written at full precision survive the way through MJCF."""
    law = Friction(coulomb=0.1 + 0.2, presliding_stiffness=1e5 / 3)
    spec = mujoco.MjSpec.from_string(mjcf(element(law)))
    again = mujoco.MjSpec.from_string(spec.to_xml())
    assert dict(again.actuators[0].plugin.config) == config(law)
