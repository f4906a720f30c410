"""A stretch of a run as it will be replayed, before its instruments are read; and what drives it: angles and loads."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.sparse import csr_array

from bench.diagnose.replay.uneven_derivative import derivative_over
from bench.record.campaign import Array, Run
from bench.record.carried import states_load
from bench.robot.compiled import CompiledRobot
from bench.simulate.prescribed import Motion

SAMPLES_OF_SPEED = 5  # exact: as many as motion is differentiated over at least
STEP_S = 1e-3  # rounding: [s], between delays at which motion is known; a cubic errs by 1e-3 of what they change
SAMPLES_OF_PARABOLA = 4  # exact: fewer samples have no curvature to speak of


@dataclass(frozen=True, eq=False)
class Path:
    """Where the motors were at every sample of a motion, and which samples make the T instants that are read of it.

    Attributes:
        time: Shape (rows,) [s].
        angles: Shape (rows, n) [rad] or [m].
        groups: T arrays of rows.
        kernel: Of odd length; with its weights torques are averaged as accelerations are, with 1 where that is not
            possible.
        reach: Samples that a torque may be averaged over, if its group has fewer.
        window: Samples over which motion was differentiated.
    """

    time: Array
    angles: Array
    groups: tuple[NDArray[np.int64], ...]
    kernel: Array
    reach: int = 1
    window: int = SAMPLES_OF_SPEED

    @cached_property
    def of_torque(self) -> tuple[tuple[NDArray[np.int64], Array], ...]:
        """Rows and weights that make each reading of a torque."""
        return tuple(map(self.as_torque, self.groups))

    def as_torque(self, group: NDArray[np.int64]) -> tuple[NDArray[np.int64], Array]:
        """Return rows and weights with which a torque is averaged over a group: those of `inner`, spread by the kernel.

        Beyond the ends of the run the last sample stands for all.
        """
        half, last, inner = len(self.kernel) // 2, len(self.time) - 1, self.inner(group)
        rows = np.clip(np.arange(inner[0] - half, inner[-1] + half + 1), 0, last)
        return rows, np.convolve(centre_weights(len(inner)), self.kernel)

    def averaged(self, speed: Array, groups: Sequence[NDArray[np.int64]]) -> Array:
        """Return speeds, shape (rows, n), averaged over groups as torques are, shape (T, n).

        Viscous friction of the speed in the middle of a ramp is not that of its average: as a delay, the difference
        is half the variance of the weights times f_v / J, half a millisecond in a log of 50 Hz.
        """
        return np.stack([weights @ speed[rows] for rows, weights in map(self.as_torque, groups)])

    def mean_of(self, values: Array) -> Array:
        """Return values at every sample, shape (rows, ...), averaged as the torques that are read, shape (T, ...)."""
        return np.asarray(self._averages[1] @ values)

    def inner(self, group: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the rows of a group whose accelerations make its own, each of which is an average itself.

        So many are left out on both sides that no reading is averaged over more than its group, or `reach`: what a
        torque shows over the angle would be blurred.
        """
        most = max(len(group), self.reach)
        trim = max(0, (len(group) + len(self.kernel) - most) // 2)
        return group[trim : len(group) - trim]

    def earlier(self, seconds: float) -> Array:
        """Return how much further the motors were some time before each instant, shape (T, n) [rad] or [m].

        Before its first sample, and after its last, the arm is taken to move as fast as there.
        """
        angles, _, _ = self._averages
        return np.asarray(angles @ self._moved(seconds))

    def motion_earlier(self, seconds: float) -> tuple[Array, Array, Array]:
        """Return by how much angles, speeds and accelerations were other ones some time before, shape (T, n) each.

        A fit of delays asks for thousands of times. What is averaged over samples changes smoothly with them, so it is
        made at whole milliseconds, and a cubic runs through the four that are nearest.
        """
        first = int(np.floor(seconds / STEP_S)) - 1
        parts = [self._at_step(first + k) for k in range(4)]
        weights = np.linalg.solve(
            np.vander(np.arange(4.0), increasing=True).T, (seconds / STEP_S - first) ** np.arange(4)
        )
        angles, speeds, accelerations = (np.tensordot(weights, np.stack(part), 1) for part in zip(*parts, strict=True))
        return angles, speeds, accelerations

    def _at_step(self, step: int) -> tuple[Array, Array, Array]:
        """Return `motion_earlier` at a whole number of steps."""
        if step not in self._at_steps:
            self._at_steps[step] = self.motion_of(self._moved(step * STEP_S))
        return self._at_steps[step]

    @cached_property
    def _at_steps(self) -> dict[int, tuple[Array, Array, Array]]:
        return {}

    def motion_of(self, moved: Array) -> tuple[Array, Array, Array]:
        """Return what a change of the angles of every sample, shape (rows, n), changes at the instants that are read.

        Returns:
            Of angles, speeds and accelerations, shape (T, n) each.
        """
        speed, acceleration = (derivative_over(moved, self.time, self.window, order) for order in (1, 2))
        angles, of_speed, of_acceleration = self._averages
        return angles @ moved, of_speed @ speed, of_acceleration @ acceleration

    def wave(self, period: float, drive: int) -> NDArray[np.complex128]:
        """Return the mean of exp(2 pi i x / period) over what each torque averages, shape (T,), of a drive at x."""
        return np.asarray(self._averages[1] @ np.exp(2j * np.pi / period * self.angles[:, drive]))

    @cached_property
    def _averages(self) -> tuple[csr_array, csr_array, csr_array]:
        """What makes angles, speeds and accelerations that are read of those at every sample, shape (T, rows) each.

        A fit of delays asks for them thousands of times.
        """
        rows = len(self.time)
        angles, accelerations = (
            matrix_of([(group, centre_weights(len(group))) for group in groups], rows)
            for groups in (self.groups, [self.inner(group) for group in self.groups])
        )
        return angles, matrix_of(self.of_torque, rows), accelerations

    @cached_property
    def speeds(self) -> Array:
        """Speeds of the motors at every sample, shape (rows, n)."""
        return derivative_over(self.angles, self.time, self.window, 1)

    def _moved(self, seconds: float) -> Array:
        """Return how much further the motors were some time before each sample, shape (rows, n)."""
        when = self.time - seconds
        inside = np.clip(when, self.time[0], self.time[-1])
        speed = np.where((when < self.time[0])[:, None], self._ends[0], self._ends[1])
        moved: Array = self._spline(inside) + (when - inside)[:, None] * speed - self.angles
        return moved

    @cached_property
    def _spline(self) -> CubicSpline:
        return CubicSpline(self.time, self.angles)

    @cached_property
    def _ends(self) -> tuple[Array, Array]:
        """Speeds at the first and at the last sample, shape (n,) each, of parabolas through the samples nearest."""
        found = []
        for rows, end in ((slice(None, SAMPLES_OF_SPEED), 0), (slice(-SAMPLES_OF_SPEED, None), -1)):
            basis = np.vander(self.time[rows] - self.time[end], 3, increasing=True)
            found.append(np.linalg.lstsq(basis, self.angles[rows])[0][1])
        return found[0], found[1]


@dataclass(frozen=True, eq=False)
class AverageExcess:
    """What averaged torques have more than those of the averaged motion (`average_excess.py`); T instants, n drives.

    Attributes:
        regressor: Shape (T, n, 10 n), of links by their inertial parameters (`standard_parameters`).
        balance: Shape (T, n) [Nm] or [N], of the nominal counterbalance.
    """

    regressor: Array
    balance: Array

    def torque(self, parameters: Array) -> Array:
        """Return it for inertial parameters, shape (10 n,); shape (T, n) [Nm] or [N]."""
        return np.asarray(self.balance + self.regressor @ parameters)


@dataclass(frozen=True, eq=False)
class SegmentInput:
    """T instants of a run; n drives.

    Attributes:
        label: Run, and pose and approach of a static visit.
        groups: T arrays, the rows of the run that make each instant.
        motion: What the motors did, with the instants before that shape friction.
        acceleration_error: Shape (T, n), standard deviation of the motors' accelerations, as differentiated.
        drive_error: Shape (2, T, n), the same of links and of rotors as averaged torques have them; None: no torque is
            averaged as accelerations are.
        turning: Shape (T, n) bool, drives that start, stop or turn round: their friction is between its levels.
        rings: Shape (T,) bool, instants so soon after a jerk that the arm may still ring.
        path: Every sample of the motors; None at rest.
        average_excess: What torques have more for being averaged; None at rest.
    """

    label: str
    groups: tuple[NDArray[np.int64], ...]
    motion: Motion
    acceleration_error: Array
    turning: NDArray[np.bool_]
    rings: NDArray[np.bool_]
    path: Path | None = None
    drive_error: Array | None = None
    average_excess: AverageExcess | None = None

    @property
    def rows(self) -> NDArray[np.int64]:
        """Rows of the run that it rests on."""
        return np.concatenate(self.groups)


def angles_of(run: Run, compiled: CompiledRobot) -> Array:
    """Return motor angles by encoder, where there is none by command, shape (rows, n)."""
    n = compiled.n_joints
    keys = tuple(str(i + 1) for i in range(n))
    measured, commanded = (
        np.where(np.isnan(rad), run.stack(quantity, "m", keys), rad)
        for quantity, rad in ((q, run.stack(q, "rad", keys)) for q in ("q_motor", "q_cmd"))
    )
    angles: Array = np.where(np.isnan(measured), commanded, measured)
    return angles


def wrench_of(run: Run, compiled: CompiledRobot) -> Array:
    """Return the wrench on the load point without the weight of what is bolted to it, shape (rows, 6)."""
    wrench = np.array(run.load_wrench())
    if not states_load(run):
        keys = ("x", "y", "z")
        sensed = np.concatenate([run.stack("force", "n", keys), run.stack("moment", "nm", keys)], axis=1)
        felt: Array = np.nan_to_num(sensed)
        return felt
    if "load_mass_kg" in run.columns:
        wrench[:, :3] -= run.columns["load_mass_kg"][:, None] * compiled.model.opt.gravity
    wrench[np.abs(wrench) < 1e-6] = 0.0
    return wrench


def matrix_of(sums: Sequence[tuple[NDArray[np.int64], Array]], rows: int) -> csr_array:
    """Return weighted sums of rows as a matrix, shape (len(sums), rows); rows that stand twice count twice."""
    lengths = [len(weights) for _, weights in sums]
    where = np.repeat(np.arange(len(sums)), lengths), np.concatenate([which for which, _ in sums])
    return csr_array((np.concatenate([weights for _, weights in sums]), where), shape=(len(sums), rows))


@lru_cache(maxsize=1000)
def centre_weights(n: int) -> Array:
    """Return weights of n equidistant samples that give a parabola's value at their middle, shape (n,).

    A plain mean would cut the corners: a reflector on an arc of 2 m moves 0.4 mm inwards over a bin of four degrees.
    """
    if n < SAMPLES_OF_PARABOLA:
        return np.full(n, 1 / n)
    basis = np.vander(np.linspace(-1, 1, n), 3, increasing=True)
    weights: Array = np.linalg.pinv(basis)[0]
    return weights
