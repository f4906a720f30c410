"""The benchmark compares like with like."""

from pathlib import Path

import mujoco
import numpy as np

from bench.actuators.laws import Friction
from bench.benchmark.actuators import measure, step_times
from bench.cli import main
from tests.actuators.slider import element, mjcf

FRICTION = Friction(coulomb=100, presliding_stiffness=1e6)
ARM = """<mujoco model="arm"><worldbody>
  <body name="link"><joint name="turn" axis="0 1 0" range="-90 90"/><geom size=".1" pos=".5 0 0" mass="10"/></body>
</worldbody></mujoco>"""


def ratio(spec: mujoco.MjSpec) -> float:
    spent = step_times(spec, rounds=20)
    return float(np.median(spent[:, 1] / spent[:, 0]))


def test_actuators_cost_something_but_not_much():
    actuators = "".join(element(FRICTION, f"friction{i}") for i in range(20))
    spec = mujoco.MjSpec.from_string(mjcf(actuators + '<motor name="motor" joint="x"/>'))
    assert 0.1 < ratio(spec) < 1
    assert len(spec.actuators) == 21


def test_model_without_actuators_of_this_package_is_as_fast_as_itself():
    spec = mujoco.MjSpec.from_string(mjcf('<motor name="motor" joint="x"/>'))
    assert 0.5 < ratio(spec) < 2


def test_robot_that_new_robot_made(tmp_path: Path):
    (tmp_path / "arm.xml").write_text(ARM)
    folder = tmp_path / "robot"
    assert main(["new-robot", "arm", "--mjcf", str(tmp_path / "arm.xml"), "-o", str(folder)]) == 0
    (row,) = measure([str(folder)])
    assert row.ratio
    assert row.value > 0
