"""Counterbalance, friction and tabulated torque as actuators inside MuJoCo; README.md beside this file has the laws.

The actuators are an engine plugin in C, which MuJoCo loads by itself when it is imported (entry point
`mujoco.plugins`). `bench.actuators.laws` holds the same laws in NumPy.
"""

import ctypes
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from bench.errors import MissingPluginError

_LIBRARY = "bench/actuators/libbench_actuators.so"


def library() -> Path:
    """Return the file of the engine plugin.

    It lies where the distribution was installed. That is not always beside this file: an editable installation, or
    Python started in the repository, takes the sources from elsewhere.

    Raises:
        MissingPluginError: The package is not installed, or was installed without the library.
    """
    advice = "install the package with `pip install .`, which builds it"
    try:
        path = Path(str(distribution("hh150-bench").locate_file(_LIBRARY)))
    except PackageNotFoundError as fault:
        raise MissingPluginError(
            f"the engine plugin is not there because hh150-bench is not installed; {advice}"
        ) from fault
    if not path.is_file():
        raise MissingPluginError(f"the engine plugin {path} was not built; {advice}")
    return path


def register() -> None:
    """Make the actuators known to MuJoCo. Calling it again changes nothing.

    Raises:
        MissingPluginError: The library was not built, or does not fit the installed MuJoCo.
    """
    import mujoco  # noqa: F401  the library needs MuJoCo's symbols; MuJoCo itself calls this while it is imported

    path = library()
    try:
        ctypes.CDLL(str(path))
    except OSError as fault:
        raise MissingPluginError(
            f"the engine plugin {path} cannot be loaded ({fault}); install the package again"
        ) from fault
