"""What README.md of the actuators says is so."""

import re
from dataclasses import MISSING, fields
from math import isnan
from pathlib import Path

import mujoco
import numpy as np
import pytest

import bench.actuators
from bench.actuators.laws import Friction, GasSpring, TorqueTable
from tests.actuators.slider import NAMES, Law

README = Path(bench.actuators.__file__).with_name("README.md").read_text()


def test_example_compiles_and_comes_to_rest():
    (example,) = re.findall(r"```xml\n(.*?)```", README, flags=re.S)
    model = mujoco.MjModel.from_xml_string(example)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 4000)
    assert np.all(np.isfinite(data.qpos))
    assert np.max(np.abs(data.qvel)) < 1e-3


@pytest.mark.parametrize("law", [GasSpring, Friction, TorqueTable])
def test_tables_have_every_attribute_and_default(law: type[Law]):
    section = README.split(f"## `{NAMES[law]}`")[1].split("\n## ")[0]
    rows = {
        row[0]: row[3].strip() for row in re.findall(r"^\| `(\w+)` \|(.*?)\|(.*?)\|(.*?)\|.*\|$", section, flags=re.M)
    }
    assert set(rows) == {field.name for field in fields(law)}
    for field in fields(law):
        default = rows[field.name]
        if field.default is MISSING:
            assert default == ""
        elif field.default == "" or isnan(field.default):
            assert default.startswith("needed ")
        else:
            assert float(default) == field.default
