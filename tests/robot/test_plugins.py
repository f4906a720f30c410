"""Plugin instances that effects name: MuJoCo keeps its memory whole."""

import subprocess
import sys
from pathlib import Path
from textwrap import dedent

import pytest

from bench.robot.compiled import read_spec
from bench.robot.folder import load_robot
from bench.robot.plugins import name_instances
from bench.robot.starter.folder import start_robot
from bench.robot.starter.source import read_source

MANY = 40  # copies of a copy; with `plugin_name` set on an unnamed instance, MuJoCo 4.0.0 dies within the first 20


LINK = '<body pos="0 0 0.3"><joint name="j{}" axis="0 1 0"/><geom size="0.1" mass="5"/>'


@pytest.fixture
def started(tmp_path: Path) -> Path:
    """Return a robot whose friction elements have instances without names, as `bench new-robot` writes them."""
    links = "".join(LINK.format(i) for i in range(6))
    (tmp_path / "stick.xml").write_text(f"<mujoco><worldbody>{links}{'</body>' * 6}</worldbody></mujoco>")
    start_robot("stick", read_source(tmp_path / "stick.xml"), tmp_path / "stick")
    return tmp_path / "stick"


def test_naming_instances_leaves_the_engine_alive(started: Path) -> None:
    script = f"""
        from bench.robot.compiled import read_spec
        from bench.robot.folder import load_robot
        from bench.robot.plugins import name_instances

        spec = read_spec(load_robot({str(started)!r})).copy()
        for _ in range({MANY}):
            own = spec.copy()
            name_instances(own)
            for part in range(20):
                own.worldbody.add_body(name=f"part {{part}}", mass=1.0, inertia=[0.1] * 3, explicitinertial=True)
    """
    done = subprocess.run([sys.executable, "-c", dedent(script)], check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_what_was_named_is_saved(started: Path) -> None:
    spec = read_spec(load_robot(started))
    assert any(not plugin.name for plugin in spec.plugins)
    name_instances(spec)
    spec.compile()
    names = {actuator.plugin.name for actuator in spec.actuators if actuator.plugin.active}
    assert names
    assert all(name.startswith("effect/") and f'<instance name="{name}">' in spec.to_xml() for name in names)
