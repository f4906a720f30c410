"""Steps along a path in C (`bench/actuators/plugin/track.c`), without the interpreter and without its lock.

Between instants that are read nobody looks at sensors, contacts, constraints and bodies that stand still; such steps
are done without them, equal to MuJoCo's within rounding. Whatever a model has that this leaves out (contact, rubbing
constraints, other integrators, ...) and whatever is rare (a limit, a servo at its torque limit) is stepped by MuJoCo.
"""

import ctypes
from dataclasses import dataclass
from functools import lru_cache
from typing import Self

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.actuators import library
from bench.errors import MissingPluginError
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
        ("goes_on", ctypes.c_int64),
        ("nread", ctypes.c_int64),
        ("rows", ctypes.c_void_p),
        ("records", ctypes.c_void_p),
    )


@lru_cache(maxsize=1)
def _functions() -> ctypes.CDLL:
    path = library()
    functions = ctypes.CDLL(str(path))
    if not hasattr(functions, "track_run"):
        raise MissingPluginError(f"{path} is of another version than the Python files; install the package again")
    functions.track_size.restype = ctypes.c_int64
    functions.track_prepare.argtypes = (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64)
    functions.track_run.argtypes = (ctypes.c_void_p,) * 4
    functions.track_run.restype = ctypes.c_int64
    return functions


@dataclass(frozen=True)
class Seen:
    """What was read at K steps.

    Attributes:
        records: Shape (K, nsensordata + 7 + nv); the other attributes are its columns.
        sensors: Shape (K, nsensordata), at the instants at which the steps begin.
        wrench: Shape (K, 6) [N, Nm], on the load point at these instants.
        time: Shape (K,) [s], of these instants.
        velocities: Shape (K, nv), at the instants at which the steps end.
    """

    records: Array
    sensors: Array
    wrench: Array
    time: Array
    velocities: Array

    @classmethod
    def of(cls, records: Array, n_sensors: int) -> Self:
        """Name the columns of records."""
        after = n_sensors + 7
        columns = records[:, :n_sensors], records[:, n_sensors : after - 1], records[:, after - 1], records[:, after:]
        return cls(records, *columns)


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
        self._n, self._n_sensors, self._width = compiled.n_joints, data.sensordata.size, data.sensordata.size + 7
        self._width += data.qvel.size
        self._servo_ctrl = np.ascontiguousarray(compiled.at.servo_ctrl, dtype=np.int64)
        self._memory = np.zeros(functions.track_size() // 8 + 1)
        self._addresses = (self._memory.ctypes.data, self._model._address, self._data._address)
        self.is_lean = bool(functions.track_prepare(*self._addresses[:2], compiled.at.load_body))
        self.whole_steps = 0
        self._fixed = {
            "ndrive": self._n,
            "servo_ctrl": self._servo_ctrl.ctypes.data,
            "load_body": int(compiled.at.load_body),
        }
        self._one: _OnePeriod | None = None

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

        Raises:
            ValueError: Arrays do not fit each other or the robot.
        """
        path = np.asarray(path, dtype=np.float64)
        if path.ndim != 3 or path.shape[2] != self._n or wrenches.shape != (path.shape[1] + 1, 6):
            raise ValueError(f"a path {path.shape} and wrenches {wrenches.shape} do not fit {self._n} drives")
        if path.strides[1:] != (8 * self._n, 8):  # a slice of the periods of a longer path is taken as it is
            path = np.ascontiguousarray(path)
        wrenches, rows = np.ascontiguousarray(wrenches, dtype=np.float64), np.ascontiguousarray(rows, dtype=np.int64)
        if len(rows) and (rows[0] < 0 or rows[-1] >= path.shape[1] * substeps or np.any(np.diff(rows) <= 0)):
            raise ValueError(f"steps that are read must grow from 0 to below {path.shape[1] * substeps}")
        records = np.empty((len(rows), self._width))
        course = _Course(
            nperiod=path.shape[1],
            substeps=substeps,
            order=path.shape[0],
            pitch=path.strides[0] // 8,
            path=path.ctypes.data,
            ahead=ahead,
            wrenches=wrenches.ctypes.data,
            nread=len(rows),
            rows=rows.ctypes.data,
            records=records.ctypes.data,
            **self._fixed,
        )
        self.whole_steps = self._run(*self._addresses, ctypes.byref(course))
        return Seen.of(records, self._n_sensors)

    def run_one(
        self, before: Array, after: Array, wrenches: tuple[Array, Array], period: float, substeps: int
    ) -> Array:
        """Follow a straight path for one period and read at its last step: `run` without what costs time.

        Args:
            before: Shape (n,) [rad], command at the beginning of the period.
            after: Shape (n,) [rad], command at its end.
            wrenches: Each shape (6,) [N, Nm], at the same times.
            period: [s].
            substeps: Integration steps in it.

        Returns:
            Record of that step, shape (1, nsensordata + 7 + nv), which the next call overwrites.
        """
        if self._one is None or self._one.substeps != substeps:
            self._one = _OnePeriod(self._n, self._width, substeps, self._fixed)
        one = self._one
        np.subtract(after, before, out=one.slope)
        one.slope /= period
        one.start[:] = before
        one.wrenches[0], one.wrenches[1] = wrenches
        self.whole_steps = self._run(*self._addresses, one.reference)
        return one.records


class _OnePeriod:
    """Memory for the calls of `Tracker.run_one`."""

    def __init__(self, n: int, width: int, substeps: int, fixed: dict[str, int]) -> None:
        self.substeps = substeps
        self._path, self.wrenches, self.records = np.zeros((2, 1, n)), np.zeros((2, 6)), np.zeros((1, width))
        self.slope, self.start = self._path[0, 0], self._path[1, 0]
        self._rows = np.array([substeps - 1], dtype=np.int64)
        self._course = _Course(
            nperiod=1,
            substeps=substeps,
            order=2,
            pitch=n,
            path=self._path.ctypes.data,
            wrenches=self.wrenches.ctypes.data,
            goes_on=1,
            nread=1,
            rows=self._rows.ctypes.data,
            records=self.records.ctypes.data,
            **fixed,
        )
        self.reference = ctypes.byref(self._course)
