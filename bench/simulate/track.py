"""Steps along a path in C (`bench/actuators/plugin/track.c`), without the interpreter and without its lock.

Between instants that are read nobody looks at sensors, contacts, constraints and bodies that stand still; such steps
are done without them, equal to MuJoCo's within rounding. Whatever a model has that this leaves out (contact, rubbing
constraints, other integrators, ...) and whatever is rare (a limit, a servo at its torque limit) is stepped by MuJoCo.
"""

import ctypes
from dataclasses import dataclass
from functools import lru_cache

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.actuators import library
from bench.robot.compiled import CompiledRobot

Array = NDArray[np.float64]
Rows = NDArray[np.int64]


class _Course(ctypes.Structure):
    """`Course` of track.h; there it says what each field holds."""

    _fields_ = (
        ("nperiod", ctypes.c_int64),
        ("substeps", ctypes.c_int64),
        ("ndrive", ctypes.c_int64),
        ("servo_ctrl", ctypes.c_void_p),
        ("order", ctypes.c_int64),
        ("pitch", ctypes.c_int64),
        ("path", ctypes.c_void_p),
        ("ahead", ctypes.c_double),
        ("wrenches", ctypes.c_void_p),
        ("load_body", ctypes.c_int64),
        ("nread", ctypes.c_int64),
        ("rows", ctypes.c_void_p),
        ("sensors", ctypes.c_void_p),
        ("velocities", ctypes.c_void_p),
    )


@lru_cache(maxsize=1)
def _functions() -> ctypes.CDLL:
    functions = ctypes.CDLL(str(library()))
    functions.track_size.restype = ctypes.c_int64
    functions.track_prepare.argtypes = (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64)
    functions.track_run.argtypes = (ctypes.c_void_p,) * 4
    functions.track_run.restype = ctypes.c_int64
    return functions


@dataclass(frozen=True)
class Seen:
    """What was read at K steps.

    Attributes:
        sensors: Shape (K, m.nsensordata), at the instants at which the steps begin.
        velocities: Shape (K, nv), at the instants at which they end.
    """

    sensors: Array
    velocities: Array


class Tracker:
    """Steps one model; the state is that of the data.

    Args:
        compiled: The robot; its model and its data stay alive and in place as long as this is used.
        data: The state.

    Attributes:
        is_lean: Whether steps that nobody looks at are done without what nothing depends on.
        whole_steps: How many steps MuJoCo did itself the last time.
    """

    def __init__(self, compiled: CompiledRobot, data: mujoco.MjData) -> None:
        functions = _functions()
        self._model, self._data, self._run = compiled.model, data, functions.track_run
        self._servo_ctrl = np.ascontiguousarray(compiled.at.servo_ctrl, dtype=np.int64)
        self._memory = np.zeros(functions.track_size() // 8 + 1)
        self._addresses = (self._memory.ctypes.data, self._model._address, self._data._address)
        self.is_lean = bool(functions.track_prepare(*self._addresses[:2], compiled.at.load_body))
        self.whole_steps = 0
        self._course = _Course(
            ndrive=compiled.n_joints, servo_ctrl=self._servo_ctrl.ctypes.data, load_body=compiled.at.load_body
        )

    def run(self, path: Array, wrenches: Array, substeps: int, rows: Rows, ahead: float = 0.0) -> Seen:
        """Follow a path of the motors.

        Args:
            path: Shape (k, P, n), coefficients of polynomials in the time since the beginning of each period [s], from
                the highest power down, as `scipy.interpolate.PPoly` keeps them.
            wrenches: Shape (P + 1, 6) [N, Nm], on the load point before the first and at the end of each period;
                linear between.
            substeps: Integration steps in a period.
            rows: Shape (K,), steps at which is read, growing.
            ahead: By how much later the velocity set point is taken than that of the position [s].
        """
        inside = path.strides[1:] == (8 * path.shape[2], 8)
        path = path if inside else np.ascontiguousarray(path)
        wrenches, rows = np.ascontiguousarray(wrenches, dtype=np.float64), np.ascontiguousarray(rows, dtype=np.int64)
        model, course = self._model, self._course
        seen = Seen(np.empty((len(rows), model.nsensordata)), np.empty((len(rows), model.nv)))
        course.nperiod, course.substeps = path.shape[1], substeps
        course.order, course.pitch, course.path = path.shape[0], path.strides[0] // 8, path.ctypes.data
        course.ahead, course.wrenches = ahead, wrenches.ctypes.data
        course.nread, course.rows = len(rows), rows.ctypes.data
        course.sensors, course.velocities = seen.sensors.ctypes.data, seen.velocities.ctypes.data
        self.whole_steps = self._run(*self._addresses, ctypes.byref(course))
        return seen
