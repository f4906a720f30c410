"""MuJoCo finds the actuators by itself, once, and says so when it cannot."""

import shutil
import subprocess
import sys
from importlib.machinery import PathFinder
from pathlib import Path

import pytest

import bench.actuators
from bench.actuators import library, register
from bench.errors import MissingPluginError
from tests.actuators.slider import element, mjcf
from tests.actuators.test_configuration import FRICTION, GAS


def python(code: str, *arguments: str) -> None:
    """Run code in a new interpreter in which warnings are errors."""
    subprocess.run([sys.executable, "-W", "error", "-c", code, *arguments], check=True)


def test_plain_mujoco_opens_a_model():
    python(
        "import sys, mujoco; mujoco.MjModel.from_xml_string(sys.argv[1])", mjcf(element(GAS) + element(FRICTION, "f"))
    )


def test_registering_again_changes_nothing():
    register()
    python("from bench.actuators import library, register; register(); register(); import mujoco; register()")


def test_second_copy_of_the_library_is_harmless(tmp_path: Path):
    second = shutil.copy(library(), tmp_path / "copy.so")
    code = "import sys, ctypes, mujoco; ctypes.CDLL(sys.argv[1]); mujoco.MjModel.from_xml_string(sys.argv[2])"
    python(code, second, mjcf(element(GAS)))


def test_importing_the_package_does_not_import_mujoco():
    python(
        "import sys, bench.actuators, bench.actuators.laws, bench.actuators.state; assert 'mujoco' not in sys.modules"
    )


def test_library_that_was_not_built(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(bench.actuators, "_LIBRARY", "bench/actuators/absent.so")
    with pytest.raises(MissingPluginError, match=r"absent\.so was not built; install the package with"):
        register()


def test_library_that_does_not_load(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "broken.so").write_text("not a library")
    monkeypatch.setattr(bench.actuators, "_LIBRARY", str(tmp_path / "broken.so"))
    with pytest.raises(MissingPluginError, match=r"broken\.so cannot be loaded \(.*\); install the package again"):
        register()


def test_package_that_is_not_installed(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(sys, "path", [])
    monkeypatch.setattr(sys, "meta_path", [PathFinder])
    with pytest.raises(MissingPluginError, match="hh150-bench is not installed; install the package with"):
        register()
