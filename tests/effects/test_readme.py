"""What README.md of the effects says is so."""

import re
from pathlib import Path

import numpy as np

import bench.effects
from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.listing import markdown_table
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import Robot

README = Path(bench.effects.__file__).with_name("README.md").read_text()


def test_example_is_an_entry(tmp_path: Path, small: Robot, small_compiled: CompiledRobot) -> None:
    (example,) = re.findall(r"```python\n(.*?)```", README, flags=re.S)
    file = tmp_path / "brake.py"
    file.write_text(example)
    effect = catalogue([file])["brake_drag"]
    place = effect.places(small_compiled)[0]
    warm = Conditions(np.full(2, 293.15), np.array([303.15, 293.15]))
    assert effect.edit(place, effect.complete({}), warm) is None
    edit = effect.edit(place, {"slope": 3.0}, warm)
    assert edit is not None
    changed = compile_robot(small, [edit]).model.dof_damping - small_compiled.model.dof_damping
    assert changed[small_compiled.at.q_dof[0]] == 30.0


def test_table_is_the_catalogue() -> None:
    assert README.split("<!-- table -->\n")[1].strip() == markdown_table(catalogue())
