"""The compiled HH-150 and the script that derives its numbers."""

import importlib
from pathlib import Path
from types import ModuleType

import mujoco
import numpy as np
import pytest

HH150 = Path(__file__).parents[2] / "models" / "hh150"
JOINTS = range(1, 7)


@pytest.fixture(scope="session")
def derive() -> ModuleType:
    """`models/hh150/derive.py`; its `arm` is `models/hh150/arm.py`."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(HH150))
        return importlib.import_module("derive")


@pytest.fixture(scope="session")
def model() -> mujoco.MjModel:
    """Compile the robot as `hh150.xml` has it; not to be changed."""
    return mujoco.MjModel.from_xml_path(str(HH150 / "hh150.xml"))


@pytest.fixture
def slippery() -> mujoco.MjModel:
    """Compile the robot without static friction; free to be changed."""
    spec = mujoco.MjSpec.from_file(str(HH150 / "hh150.xml"))
    for plugin in spec.plugins:
        if plugin.name.endswith("_friction"):
            plugin.config = {**plugin.config, "coulomb": "0"}
    return spec.compile()


@pytest.fixture
def data(model: mujoco.MjModel) -> mujoco.MjData:
    return mujoco.MjData(model)


def theta_dofs(model: mujoco.MjModel) -> np.ndarray:
    """Return where the link joints stand in qvel, and in qpos, as all joints are hinges."""
    return np.array([model.joint(f"joint{i}").dofadr[0] for i in JOINTS])


def rotor_dofs(model: mujoco.MjModel) -> np.ndarray:
    """Return where the rotors stand in qvel and qpos."""
    return np.array([model.joint(f"rotor{i}").dofadr[0] for i in JOINTS])


def put(model: mujoco.MjModel, data: mujoco.MjData, theta: np.ndarray) -> None:
    """Put links and rotors at theta [rad] with nothing stretched, and compute everything."""
    data.qpos[theta_dofs(model)] = data.qpos[rotor_dofs(model)] = theta
    mujoco.mj_forward(model, data)


def random_angles(model: mujoco.MjModel, rng: np.random.Generator) -> np.ndarray:
    """Return link angles [rad] anywhere in their ranges."""
    low, high = np.array([model.joint(f"joint{i}").range for i in JOINTS]).T
    return rng.uniform(low, high)
