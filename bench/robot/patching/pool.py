"""Objects of MuJoCo that are used again when nobody holds them any more.

MuJoCo copies a model in 2 us. To make the Python object around it, with its 400 arrays, takes 125 us, and that around
data 360 us, so the objects are kept. An array of a model does not keep the model: who needs one for longer holds the
model, or copies the array.
"""

import ctypes
import sys
from collections.abc import Callable, Sequence
from functools import cache
from typing import Generic, TypeVar

from bench.actuators import library

MOST = 144  # objects kept; more than robots are remembered, for most of them hold one
T = TypeVar("T")


class Pool(Generic[T]):
    """Objects of one kind.

    Args:
        make: Makes one more.
    """

    def __init__(self, make: Callable[[], T]) -> None:
        self._make = make
        self._kept: list[T] = []

    def take(self) -> T:
        """Return an object that nobody else holds, as it was left. Not for several threads at once."""
        for i in range(len(self._kept)):
            if _references(self._kept, i) == _UNUSED:
                return self._kept[i]
        made = self._make()
        if len(self._kept) < MOST:
            self._kept.append(made)
        return made


def _references(things: Sequence[object], index: int) -> int:
    return sys.getrefcount(things[index])


_UNUSED = _references([object()], 0)  # of a thing that only its list holds


@cache
def engine() -> ctypes.PyDLL:
    """Return C functions of MuJoCo and of the plugin that Python does not have; they keep the interpreter's lock."""
    functions = ctypes.PyDLL(str(library()))  # and with it the MuJoCo that it is linked to
    functions.mj_copyModel.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    functions.mj_copyModel.restype = ctypes.c_void_p
    functions.bench_refuses.argtypes = [ctypes.c_void_p, ctypes.c_int]
    functions.bench_refuses.restype = ctypes.c_int
    return functions
