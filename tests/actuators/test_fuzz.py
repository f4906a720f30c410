"""The laws in C under sanitizers: attributes and states of all kinds are refused or survived."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import mujoco
import pytest

PLUGIN = Path(__file__).parents[2] / "bench" / "actuators" / "plugin"
SOURCES = ("attributes.c", "friction.c", "gas_spring.c", "torque_table.c")
SANITIZERS = "-fsanitize=address,undefined,float-cast-overflow"
COUNT = 30_000  # elements; a second

NAN_PLACE = """
import mujoco, numpy as np
model = mujoco.MjModel.from_xml_string('''
<mujoco><extension><plugin plugin="bench.torque_table"/><plugin plugin="bench.friction"/></extension>
<worldbody><body><joint name="j" axis="0 1 0"/><geom size="0.1"/></body></worldbody>
<actuator><plugin plugin="bench.torque_table" joint="j"><config key="angle_min" value="-1"/>
<config key="angle_max" value="1"/><config key="forward" value="1 2 3"/><config key="backward" value="2 3 4"/>
<config key="presliding_stiffness" value="1e3"/></plugin></actuator></mujoco>''')
data = mujoco.MjData(model)
for place in (np.nan, np.inf, -np.inf, 1e308):
    data.qpos[:] = place
    mujoco.mj_forward(model, data)
    print(data.actuator_force[0])
"""


def test_a_place_that_is_no_number_gives_a_torque_that_is_none() -> None:
    done = subprocess.run([sys.executable, "-c", NAN_PLACE], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["nan", "3.5", "1.5", "3.5"]  # constant beyond the table


@pytest.fixture(scope="module")
def driver(tmp_path_factory: pytest.TempPathFactory) -> Path:
    compiler = shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        pytest.skip("there is no C compiler")
    built = tmp_path_factory.mktemp("fuzz") / "driver"
    include = Path(mujoco.__file__).parent / "include"
    sources = [str(PLUGIN / name) for name in SOURCES] + [str(Path(__file__).parent / "fuzz" / "driver.c")]
    flags = ["-std=c11", "-O1", "-g", SANITIZERS, "-fno-sanitize-recover=all", f"-isystem{include}", f"-I{PLUGIN}"]
    done = subprocess.run([compiler, *flags, *sources, "-lm", "-o", str(built)], capture_output=True, text=True)
    if "cannot find -lasan" in done.stderr or "cannot find -lubsan" in done.stderr:
        pytest.skip("the compiler has no sanitizers")
    assert done.returncode == 0, done.stderr
    return built


@pytest.mark.parametrize("seed", range(1, 4))
def test_laws_survive_what_they_accept(driver: Path, seed: int) -> None:
    done = subprocess.run([str(driver), str(seed), str(COUNT)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    accepted, forces = map(int, re.findall(r"\d+", done.stdout))
    assert accepted > COUNT / 100  # else nothing was tried
    assert forces > accepted
