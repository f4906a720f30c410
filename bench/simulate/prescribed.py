"""The robot along a prescribed motion of its motors: what torque that takes, and where the links are.

The direction in which measured motion is replayed: motor angles, velocities and accelerations in, motor torques out.
The links follow quasi-statically: each sits on its elastic element where gravity, inertia, counterbalance, friction and
load balance, and moves as its motor does, if nothing else is said. What rings is left out. Any other hinge of the model
is a passive compliance and finds its balance in the same way. Friction elements and gas remember the path from one
instant to the next.

The search itself is in C (`bench/actuators/plugin/replay.c`), one call for any number of motions, without the
interpreter's lock; `reference_replay.py` is the same in NumPy, instant by instant, to read and to test against.
"""

import ctypes
from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields
from functools import cache
from typing import Any, Self, cast

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.actuators import library
from bench.errors import ConvergenceError
from bench.robot.compiled import CompiledRobot
from bench.simulate.equilibrium import passive_dofs
from bench.simulate.trace import Array, Trace, gas_force

TOLERANCE = 1e-6  # of the torques on the links, where a balance counts as found; a tenth of that takes 4 % longer
MAX_ITERATIONS = 100
PATIENCE = 6  # iterations after which steps are kept within brackets
STEP_RESOLUTION = 1e-13  # [rad]
LEAST_SLOPE = 0.02  # of its stiffness, for an element with play or a soft middle
MOST_SLOPE = 3.0  # of its stiffness, for an element that hardens


@dataclass(frozen=True)
class Motion:
    """Prescribed motions at T instants, one after the other; n drives.

    Attributes:
        time: Shape (T,) [s], from the start of the campaign.
        q, velocity, acceleration: Shape (T, n), of the true motor angles [rad].
        wrench: Shape (T, 6) [N, Nm], on the load point in world axes, without what is bolted to it.
        read: Shape (T,) bool; instants that are read. The others only shape what friction elements remember.
        begins: Shape (T,) bool; instants at which a motion begins and nothing is remembered. None: the first alone.
        gas_rise: Shape (T,), T / T0 - 1 of the gas of the counterbalance; where a motion begins it counts. None: it is
            as warm as its surroundings there.
    """

    time: Array
    q: Array
    velocity: Array
    acceleration: Array
    wrench: Array
    read: NDArray[np.bool_]
    begins: NDArray[np.bool_] | None = None
    gas_rise: Array | None = None

    def __len__(self) -> int:
        return len(self.time)

    @property
    def beginnings(self) -> NDArray[np.bool_]:
        """Shape (T,) bool; instants at which a motion begins."""
        return np.arange(len(self)) == 0 if self.begins is None else self.begins

    @classmethod
    def concatenate(cls, motions: Iterable["Motion"]) -> Self:
        """Join motions, each of which still begins for itself, with gas as warm as its surroundings."""
        parts = list(motions)
        names = [f.name for f in fields(cls) if f.name not in ("begins", "gas_rise")]
        joined = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
        return cls(**joined, begins=np.concatenate([part.beginnings for part in parts]))


class Prescribed:
    """One robot, moved along.

    Args:
        compiled: The robot.
        data: To work on, of a model with the same parts, whatever is left in them; None: data of its own.
        tolerance: Of the torques on the links, where a balance counts as found.
    """

    def __init__(
        self, compiled: CompiledRobot, data: mujoco.MjData | None = None, tolerance: float = TOLERANCE
    ) -> None:
        self.compiled = compiled
        self._search = _Search(tolerance, STEP_RESOLUTION, MAX_ITERATIONS, PATIENCE)
        model, at = compiled.model, compiled.at
        self._data = mujoco.MjData(model) if data is None else data
        passive = passive_dofs(compiled)
        dofs = np.concatenate([at.theta_dof, passive])
        joints = model.dof_jntid[dofs]
        springs = np.array([np.ravel(model.jnt_stiffness[joint])[0] for joint in joints[compiled.n_joints :]])
        self.stiffness = np.concatenate([compiled.stiffness, springs])
        sticking = self.stiffness.copy()
        sticking[: compiled.n_joints] += compiled.link_presliding
        is_linear = _is_linear(compiled, len(passive))
        self.slopes = Slopes(
            sliding=self.stiffness,
            sticking=sticking,
            softest=np.where(is_linear, 1.0, LEAST_SLOPE) * self.stiffness,
            stiffest=np.where(is_linear, 1.0, MOST_SLOPE) * sticking,
        )
        self.dofs, self.positions = dofs, model.jnt_qposadr[joints]
        self._kept, self._arm = _arm_of(self)

    @property
    def n_unknowns(self) -> int:
        """Links and passive hinges whose balance is sought."""
        return len(self.dofs)

    def follow(
        self, motion: Motion, guess: Array | None = None, links: tuple[Array, Array] | None = None
    ) -> tuple[Trace, Array, Array]:
        """Return the truth along a motion.

        Args:
            motion: What the motors do.
            guess: Shape (T, 2, u), what a robot with as many unknowns found along the same motion: positions [rad], and
                torques over angles [Nm/rad].
            links: Velocities and accelerations of the links, shape (T, n) each; None: those of the motors.

        Returns:
            The truth at the instants that are read. For all of them the unknown positions and stiffnesses, shape
            (T, 2, u), and what inertia, gravity, the wrench and the counterbalance ask of the elastic elements, shape
            (T, n) [Nm] or [N].

        Raises:
            ConvergenceError: No balance at some instant.
        """
        links = links or (motion.velocity, motion.acceleration)
        at, n, u = self.compiled.at, self.compiled.n_joints, self.n_unknowns
        length, rows = len(motion), np.flatnonzero(motion.read)
        sites = len(at.reflectors) + 1
        found = np.empty((length, 2, u))
        theta, torque, motor, link = (np.empty((len(rows), n)) for _ in range(4))
        load, points, cylinder = np.empty((length, n)), np.empty((len(rows), sites, 3)), np.full((len(rows), 2), np.nan)
        given = [motion.time, motion.q, motion.velocity, motion.acceleration, *links, motion.wrench]
        flags = (motion.beginnings, motion.read)
        handed: list[NDArray[Any]] = [np.ascontiguousarray(values, dtype=np.uint8) for values in flags]
        handed += [np.ascontiguousarray(values, dtype=np.float64) for values in given]
        optional = [one if one is None else np.ascontiguousarray(one, np.float64) for one in (guess, motion.gas_rise)]
        pointers = [None if one is None else one.ctypes.data for one in optional]
        course = _Course(length, *(part.ctypes.data for part in handed), *pointers)
        written = (found, load, theta, torque, motor, link, points, cylinder)
        seen = _Seen(*(part.ctypes.data for part in written), 0.0)
        failed = _replay()(
            self.compiled.model._address,
            self._data._address,
            ctypes.byref(self._arm),
            ctypes.byref(self._search),
            ctypes.byref(course),
            ctypes.byref(seen),
        )
        if failed >= 0:
            raise ConvergenceError(
                f"no balance at {motion.time[failed]:.3f} s within {MAX_ITERATIONS} iterations: "
                f"{seen.left:.3g} Nm left."
            )
        trace = Trace(
            time=motion.time[rows],
            q=motion.q[rows],
            q_velocity=motion.velocity[rows],
            theta=theta,
            theta_velocity=links[0][rows],
            motor_torque=torque,
            motor_friction=motor,
            link_friction=link,
            reflectors=points[:, :-1],
            load_point=points[:, -1],
            wrench=motion.wrench[rows],
            counterbalance_force=cylinder[:, 0],
            gas_force=gas_force(self.compiled, cylinder[:, 0], cylinder[:, 1]),
            counterbalance_length=cylinder[:, 1],
        )
        return trace, found, load


@dataclass(frozen=True)
class Slopes:
    """Torques over angles with which a search for a balance steps, shape (u,) [Nm/rad] each.

    Attributes:
        sliding, sticking: Where friction on the links slides, and where it holds.
        softest, stiffest: Least and largest of a step.
    """

    sliding: Array
    sticking: Array
    softest: Array
    stiffest: Array


def _is_linear(compiled: CompiledRobot, n_passive: int) -> NDArray[np.bool_]:
    """Return which unknowns are on a linear spring, shape (u,): elements first, then passive hinges (all linear)."""
    model, element = compiled.model, compiled.at.element
    rest = model.tendon_lengthspring[element]
    curved = np.any(model.tendon_stiffnesspoly[element] != 0, axis=1) | (rest[:, 0] != rest[:, 1])
    plastic = model.tendon_plasticadr[element] >= 0
    return np.concatenate([~(curved | plastic), np.ones(n_passive, dtype=bool)])


_address = ctypes.c_void_p


class _Search(ctypes.Structure):
    """`Search` of replay.c."""

    _fields_ = [
        ("tolerance", ctypes.c_double),
        ("step_resolution", ctypes.c_double),
        ("most_iterations", ctypes.c_int32),
        ("patience", ctypes.c_int32),
    ]


_COUNTS = ("n", "u", "nsite", "load_body", "counterbalance", "counterbalance_tendon")
_INDICES = (
    "theta",
    "theta_dof",
    "q",
    "q_dof",
    "servo",
    "motor_friction",
    "link_friction",
    "site",
    "dof",
    "position",
)
_STIFFNESSES = ("sliding", "sticking", "softest", "stiffest")


class _Arm(ctypes.Structure):
    """`Arm` of replay.c."""

    _fields_ = [*((name, ctypes.c_int32) for name in _COUNTS), *((name, _address) for name in _INDICES + _STIFFNESSES)]


_MOTORS, _LINKS = ("q", "velocity", "acceleration"), ("link_velocity", "link_acceleration")
_LAST = ("wrench", "guess", "gas_rise")


class _Course(ctypes.Structure):
    """`Course` of replay.c."""

    _fields_ = [
        ("length", ctypes.c_int32),
        *((name, _address) for name in ("begins", "read", "time", *_MOTORS, *_LINKS, *_LAST)),
    ]


class _Seen(ctypes.Structure):
    """`Seen` of replay.c."""

    _fields_ = [
        *((name, _address) for name in ("found", "load", "theta", "torque", "motor", "link", "points", "cylinder")),
        ("left", ctypes.c_double),
    ]


def _arm_of(robot: Prescribed) -> tuple[list[NDArray[Any]], _Arm]:
    """Return a robot's addresses for replay.c, and the arrays to which they point, which have to be kept."""
    at, slopes = robot.compiled.at, robot.slopes
    indices = (
        at.theta,
        at.theta_dof,
        at.q,
        at.q_dof,
        at.servo,
        at.motor_friction,
        at.link_friction,
        np.append(at.reflectors, at.load_point),
        robot.dofs,
        robot.positions,
    )
    kept: list[NDArray[Any]] = [np.ascontiguousarray(values, dtype=np.int32) for values in indices]
    kept += [np.ascontiguousarray(getattr(slopes, name), dtype=np.float64) for name in _STIFFNESSES]
    counts = (robot.compiled.n_joints, robot.n_unknowns, len(at.reflectors) + 1, at.load_body)
    cylinder = (at.counterbalance, at.counterbalance_tendon)
    return kept, _Arm(*counts, *cylinder, *(values.ctypes.data for values in kept))


@cache
def _replay() -> Callable[..., int]:
    """Return `bench_replay` of the plugin's library; a call lets other threads run."""
    function = ctypes.CDLL(str(library())).bench_replay
    function.restype = ctypes.c_int32
    function.argtypes = [_address] * 6
    return cast(Callable[..., int], function)
