"""What an effect is made of, as a digest: the code of the bench, and the files of a user's effect with their values.

A file that a user's effect reads while it is at work is not seen here; what it reads when it is imported is.
"""

import inspect
import sys
import sysconfig
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

from bench.actuators import library
from bench.effects.effect import Effect
from bench.store.digest import digest

PACKAGE = Path(inspect.getfile(Effect)).parents[1]
MAKES_SIGNATURES = ("actuators", "robot", "simulate", "effects", "identify", "diagnose/replay", "diagnose/linearise")
INSTALLED = tuple(Path(sysconfig.get_path(name)) for name in ("stdlib", "platstdlib", "purelib", "platlib"))


@lru_cache(maxsize=1)
def source_of_bench() -> str:
    """Return the digest of all code of the bench that signatures are made by, compiled code too."""
    files = sorted(file for folder in MAKES_SIGNATURES for file in (PACKAGE / folder).rglob("*.py"))
    sources = [(file.relative_to(PACKAGE).as_posix(), file.read_bytes()) for file in files]
    return digest(sources, library().read_bytes())


def source_of(effect: Effect) -> str:
    """Return the digest of an effect: its class, its state, and of a user's effect the files that it comes from.

    Raises:
        TypeError: Nobody can say when it is the same: its state has no digest, or its source cannot be found.
    """
    kind = type(effect)
    own = [one for one in kind.__mro__ if not _is_of_bench(one.__module__) and one is not object]
    files: dict[Path, bytes] = {}
    values: list[object] = []
    for one in own:
        functions = [inspect.unwrap(member) for member in vars(one).values() if isinstance(member, FunctionType)]
        if not functions:
            module = sys.modules.get(one.__module__)
            if module is None or not getattr(module, "__file__", None):
                raise TypeError(f"the source of {one.__qualname__} cannot be found")
            _collect(vars(module), Path(str(module.__file__)), files, values)
        for function in functions:
            _collect(function.__globals__, Path(function.__code__.co_filename), files, values)
    return digest(kind.__qualname__, effect.name, vars(effect), list(files.values()), values)


def _collect(names: dict[str, Any], file: Path, files: dict[Path, bytes], values: list[object]) -> None:
    """Add a file, the values that its module holds, and in the same way every module of the user that it uses."""
    if file in files or not file.is_file():
        return
    files[file] = file.read_bytes()
    for name, value in names.items():
        if name.startswith("__"):
            continue
        module = value if isinstance(value, ModuleType) else sys.modules.get(getattr(value, "__module__", None) or "")
        if module is not None and _is_of_user(module):
            _collect(vars(module), Path(str(module.__file__)), files, values)
        with suppress(TypeError):  # functions and classes count by their source
            digest(value)
            values += [name, value]


def _is_of_bench(module: str) -> bool:
    return module.split(".")[0] == "bench" or module in ("abc", "builtins", "typing")


def _is_of_user(module: ModuleType) -> bool:
    file = getattr(module, "__file__", None)
    if file is None or _is_of_bench(module.__name__):
        return False
    return not any(Path(file).is_relative_to(folder) for folder in INSTALLED)
