"""The benchmark compares like with like."""

import mujoco

from bench.actuators.benchmark import step_rate_ratio
from bench.actuators.laws import Friction
from tests.actuators.slider import element, mjcf

FRICTION = Friction(coulomb=100, presliding_stiffness=1e6)


def test_actuators_cost_something_but_not_much():
    actuators = "".join(element(FRICTION, f"friction{i}") for i in range(20))
    spec = mujoco.MjSpec.from_string(mjcf(actuators + '<motor name="motor" joint="x"/>'))
    assert 0.1 < step_rate_ratio(spec, rounds=20) < 1
    assert len(spec.actuators) == 21


def test_model_without_actuators_of_this_package_is_as_fast_as_itself():
    spec = mujoco.MjSpec.from_string(mjcf('<motor name="motor" joint="x"/>'))
    assert 0.5 < step_rate_ratio(spec, rounds=20) < 2
