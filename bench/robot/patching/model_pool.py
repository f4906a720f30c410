"""Copies of a compiled model that are used again when nobody holds them any more.

MuJoCo copies a model in 2 us; to make the Python object around it, with its 400 arrays, takes 125 us. So the object is
kept, and the numbers are copied into it once nobody else refers to it. An array of a model does not keep the model: who
needs one for longer holds the model, or copies the array.
"""

import copy
import ctypes
import sys
from functools import cache

import mujoco

from bench.actuators import library

MOST = 16  # objects kept


class ModelPool:
    """Copies of a model.

    Args:
        model: What is copied.
    """

    def __init__(self, model: mujoco.MjModel) -> None:
        self.model = model
        self._models: list[mujoco.MjModel] = []

    def copy(self) -> mujoco.MjModel:
        """Return a copy that nobody else holds. Not for several threads at once."""
        for i in range(len(self._models)):
            if _references(self._models, i) == _UNUSED:
                found = self._models[i]
                engine().mj_copyModel(found._address, self.model._address)
                return found
        found = copy.copy(self.model)
        if len(self._models) < MOST:
            self._models.append(found)
        return found


def _references(things: list[object], index: int) -> int:
    return sys.getrefcount(things[index])


_UNUSED = _references([object()], 0)  # of a thing that only its list holds


@cache
def engine() -> ctypes.PyDLL:
    """Return C functions of MuJoCo and of the plugin that Python does not have; they keep the interpreter's lock."""
    functions = ctypes.PyDLL(str(library()))  # and with it the MuJoCo that it is linked to
    functions.mj_copyModel.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
    functions.mj_copyModel.restype = ctypes.c_void_p
    functions.bench_refuses.argtypes = [ctypes.c_void_p]
    functions.bench_refuses.restype = ctypes.c_int
    return functions
