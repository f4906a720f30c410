"""Named numbers between data and verdict: which there are, and how one is changed for a while."""

import ast
import importlib
import inspect
import pkgutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from fnmatch import fnmatch
from types import ModuleType

import bench.compare
import bench.diagnose
import bench.effects
import bench.identify.dynamics
import bench.predict

# What a diagnosis takes from elsewhere; effects that are only hidden, or that only print, are no part of it.
ELSEWHERE = ("bench.record.moving", "bench.record.held_out")
APART = ("bench.effects.unlisted", "bench.effects.listing")
Number = int | float
Value = Number | tuple[Number, ...]


@dataclass(frozen=True)
class Constant:
    """A number, or a tuple of numbers, with a name in capitals at the top of a module.

    Attributes:
        module: That defines it, such as "bench.diagnose.name.search".
        name: In the module.
        value: As it stands there.
    """

    module: str
    name: str
    value: Value

    @property
    def words(self) -> str:
        """Where it stands, in the folder of the diagnosis or in the package, and its name."""
        return f"{self.module.removeprefix('bench.diagnose.').removeprefix('bench.')}.{self.name}"

    def times(self, factor: float) -> Value:
        """Return it multiplied; a whole number stays one, and at least one."""
        if isinstance(self.value, tuple):
            return tuple(_times(one, factor) for one in self.value)
        return _times(self.value, factor)


def constants_of(pattern: str = "*") -> tuple[Constant, ...]:
    """Return the constants whose words match a pattern such as "name.*", "effects.*" or "*.PROMISING"."""
    packages = (bench.diagnose, bench.effects, bench.identify.dynamics, bench.compare, bench.predict)
    infos = (info for one in packages for info in pkgutil.walk_packages(one.__path__, f"{one.__name__}."))
    names = [*(info.name for info in infos if info.name not in APART), *ELSEWHERE]
    every = (constant for name in names for constant in _constants(importlib.import_module(name)))
    return tuple(constant for constant in every if fnmatch(constant.words, pattern))


@contextmanager
def set_to(constant: Constant, value: Value) -> Iterator[None]:
    """Let a constant have another value, in its module and wherever it was imported by name.

    Defaults of arguments and of dataclasses that were read from it when their modules were imported keep the old one.
    """
    before = vars(importlib.import_module(constant.module))[constant.name]
    loaded = [module for name, module in sys.modules.items() if name.startswith("bench.")]
    places = [module for module in loaded if vars(module).get(constant.name) is before]
    try:
        for module in places:
            setattr(module, constant.name, value)
        yield
    finally:
        for module in places:
            setattr(module, constant.name, before)


def _times(value: Number, factor: float) -> Number:
    return max(1, round(value * factor)) if isinstance(value, int) else value * factor


def _constants(module: ModuleType) -> Iterator[Constant]:
    for node in ast.parse(inspect.getsource(module)).body:
        if isinstance(node, ast.Assign):
            targets = [name for target in node.targets for name in ast.walk(target)]
        elif isinstance(node, ast.AnnAssign):
            targets = [node.target]
        else:
            continue
        for target in targets:
            if isinstance(target, ast.Name) and target.id.isupper():
                value = vars(module)[target.id]
                if _is_number(value) or (isinstance(value, tuple) and value and all(map(_is_number, value))):
                    yield Constant(module.__name__, target.id, value)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
