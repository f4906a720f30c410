"""Readings at rest, as the stiffness methods need them: one row per state of load, means over the repeats."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.errors import InputError
from bench.robot.bodies import Array


@dataclass(frozen=True)
class Systematic:
    """What stays wrong however often one reads: prior standard deviations, each error with mean zero.

    These errors do not shrink with the number of readings, so every interval has to contain them.

    Attributes:
        torque_gain: Shape (n,), relative error of xi_j I_j: torque constant and current gain together, one draw per
            joint.
        force_gain: Relative error of the force sensor, one draw for all axes and states.
        force_direction: [rad], each component of the rotation between true and measured direction of a load that does
            not hang; one draw for all states.
        placement: [m], where a reflector comes to sit, each time it is carried from nest to nest.
    """

    torque_gain: Array
    force_gain: float = 0.005
    force_direction: float = 0.005
    placement: float = 15e-6


@dataclass(frozen=True)
class StaticReadings:
    """Mean readings of m states at rest, in s series.

    A series is one visit to one pose from one approach direction: the instruments stay in place, only the load changes.
    Methods compare states within a series; what is constant over a series (tracker frame, gravity at the pose, current
    offset) cancels. The rows of a series stand in the order in which they were read, because friction remembers.

    Attributes:
        series: Shape (m,) int, which series a state belongs to; 0 <= series < s.
        is_reference: Shape (m,) bool, the unloaded states; every series has one.
        q_motor: Shape (m, n) [rad], motor encoder reflected to the joint, or the command where no encoder was logged.
        current_torque: Shape (m, n) [Nm], xi_j I_j, positive where the motor pushes q_j up; nan where no current was
            logged.
        reflectors: Shape (m, r, 3) [m], tracker readings of r reflectors in the base frame; nan where missing.
        wrench: Shape (m, 6) [N, Nm], force and moment on the load point in base axes, by the force sensor; nan where
            missing.
        is_vertical: Shape (m,) bool; the load hangs, so its direction is that of gravity and was not measured.
        n_repeats: Shape (m,) int, readings behind each mean.
        sigma_current_torque: Shape (n,) [Nm], standard deviation of one reading.
        sigma_reflector: [m], standard deviation of one coordinate of one reading.
        sigma_wrench: Shape (6,) [N, Nm], standard deviation of one reading.
        reflector_names: Points of the arm on which the r reflectors sit; the first is the reference point.
        load_point: Point of the arm on which the wrench acts.
        systematic: Prior standard deviations of the instruments' systematic errors.
        sigma_q_motor: [rad], standard deviation of one reading of a motor angle.
        approach: Shape (m,) int, +1 or -1: all joints came to the pose upwards or downwards; 0 or None: not known.
    """

    series: NDArray[np.int64]
    is_reference: NDArray[np.bool_]
    q_motor: Array
    current_torque: Array
    reflectors: Array
    wrench: Array
    is_vertical: NDArray[np.bool_]
    n_repeats: NDArray[np.int64]
    sigma_current_torque: Array
    sigma_reflector: float
    sigma_wrench: Array
    reflector_names: tuple[str, ...]
    load_point: str
    systematic: Systematic
    sigma_q_motor: float = 0.0
    approach: NDArray[np.int64] | None = None

    def __post_init__(self) -> None:
        """Check shapes and series.

        Raises:
            InputError: A shape does not fit, a motor angle is missing, or a series has no unloaded state; all are
                listed.
        """
        m, n = self.q_motor.shape
        r = len(self.reflector_names)
        expected = {
            "series": (m,),
            "is_reference": (m,),
            "current_torque": (m, n),
            "reflectors": (m, r, 3),
            "wrench": (m, 6),
            "is_vertical": (m,),
            "n_repeats": (m,),
            "sigma_current_torque": (n,),
            "sigma_wrench": (6,),
        }
        if self.approach is not None:
            expected["approach"] = (m,)
        problems = [
            f"readings: {name} has shape {np.shape(getattr(self, name))}, expected {shape}."
            for name, shape in expected.items()
            if np.shape(getattr(self, name)) != shape
        ]
        if np.shape(self.systematic.torque_gain) != (n,):
            problems.append(f"readings: systematic.torque_gain needs one value per joint, {n}.")
        if not np.all(np.isfinite(self.q_motor)):
            problems.append("readings: q_motor has missing values; put the command where no encoder was logged.")
        if not problems:
            problems = [
                f"readings: series {s} has no unloaded state; read the robot unloaded at the same pose, and mark it."
                for s in np.unique(self.series)
                if not np.any(self.is_reference[self.series == s])
            ]
        if problems:
            raise InputError(problems)

    @property
    def n_joints(self) -> int:
        """Number of joints, n."""
        return int(self.q_motor.shape[1])

    @property
    def first_of_series(self) -> NDArray[np.int64]:
        """Shape (m,) int: for each state, the row of the first unloaded state of its series."""
        rows = np.arange(len(self.series))
        first = {s: rows[(self.series == s) & self.is_reference][0] for s in np.unique(self.series)}
        return np.array([first[s] for s in self.series], dtype=np.int64)

    def take(self, rows: NDArray[np.bool_]) -> "StaticReadings":
        """Return the states marked in `rows`, shape (m,)."""
        return replace(
            self,
            series=self.series[rows],
            is_reference=self.is_reference[rows],
            q_motor=self.q_motor[rows],
            current_torque=self.current_torque[rows],
            reflectors=self.reflectors[rows],
            wrench=self.wrench[rows],
            is_vertical=self.is_vertical[rows],
            n_repeats=self.n_repeats[rows],
            approach=None if self.approach is None else self.approach[rows],
        )

    def among_loaded(self) -> "StaticReadings":
        """Return the loaded states, the first of each series in the place of the unloaded one.

        While loads only rise, static friction that slid at the first load stands at the same level at the others, and
        cancels between them. Series with fewer than two loaded states are dropped.

        Raises:
            InputError: No series has two loaded states.
        """
        loaded = {s: np.flatnonzero((self.series == s) & ~self.is_reference) for s in np.unique(self.series)}
        kept = [rows for rows in loaded.values() if len(rows) > 1]
        if not kept:
            raise InputError("no pose was read under two loads, so loads cannot be held against each other.")
        first = self.is_reference.copy()
        first[[rows[0] for rows in kept]] = True
        used = np.isin(np.arange(len(self.series)), np.concatenate(kept))
        return replace(self, is_reference=first).take(used)

    def load(self, gravity: Array) -> Array:
        """Return the wrench on the load point, shape (m, 6) [N, Nm]; a load that hangs pulls along gravity alone.

        Args:
            gravity: Shape (3,) [m/s^2], world axes.
        """
        down = gravity / np.linalg.norm(gravity)
        hanging = np.zeros_like(self.wrench)
        hanging[:, :3] = (self.wrench[:, :3] @ down)[:, None] * down
        return np.where(self.is_vertical[:, None], hanging, self.wrench)
