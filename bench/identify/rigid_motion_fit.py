"""Inertia and friction of a moving axis from its motor's force: regression along measured motion.

The procedure that is standard in robot identification (M. Gautier, "Dynamic identification of robots with power
model", ICRA 1997; A. Janot, M. Gautier, M. Brunot, EMPS, 2019): positions pass a zero-phase Butterworth filter and are
differentiated by central differences, so that velocity and acceleration are not late; then every column of the
regression and the force pass one and the same low-pass and are thinned ("parallel filtering"), which keeps the linear
relation and takes away what no rigid model explains.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.record.rules.clock import JITTER

Array = NDArray[np.float64]

EDGE = 2  # thinned samples at either end that are left out: the filters see past the record there


@dataclass(frozen=True)
class Filtering:
    """How motion and force are filtered.

    Attributes:
        order: Of the Butterworth filter on positions; run forth and back, so it acts twice.
        cutoff_hz: Of the same [Hz].
        decimation: Every how many samples are kept; the low-pass before is a linear-phase FIR filter made for it.
    """

    order: int = 4
    cutoff_hz: float = 80.0
    decimation: int = 10


@dataclass(frozen=True)
class SmoothMotion:
    """Positions with their derivatives, none of them late.

    Attributes:
        position, velocity, acceleration: Shape (T, n) [rad] or [m], per s, per s^2.
    """

    position: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True)
class MotionFit:
    """Least squares of a force on named columns.

    Attributes:
        names: Of the columns.
        parameters: Shape (p,), factor of each column.
        sigma: Shape (p,), standard errors as if residuals were independent: too small where they are not.
        relative_error: Norm of the residual by norm of the force, after filtering.
        r_squared: Share of the variance of the force that is explained.
        n_samples: Thinned samples that were used.
    """

    names: tuple[str, ...]
    parameters: Array
    sigma: Array
    relative_error: float
    r_squared: float
    n_samples: int

    def __getitem__(self, name: str) -> float:
        return float(self.parameters[self.names.index(name)])


def smooth_motion(time: Array, position: Array, filtering: Filtering) -> SmoothMotion:
    """Return filtered positions and their derivatives.

    Args:
        time: Shape (T,) [s], evenly spaced.
        position: Shape (T, n).
        filtering: Order and cut-off.

    Raises:
        InputError: Time is not even, the record is too short, or the cut-off lies beyond half the sampling rate.
    """
    step = np.diff(time)
    if len(step) < 6 * filtering.order or np.ptp(step) > JITTER * np.median(step):
        raise InputError(f"motion of {len(time)} samples: needs more of them, evenly spaced; look for lost samples.")
    rate = 1 / float(np.mean(step))
    if not filtering.cutoff_hz < rate / 2:
        raise InputError(f"cut-off {filtering.cutoff_hz:g} Hz: must lie below half the sampling rate, {rate / 2:g} Hz.")
    numerator, denominator = signal.butter(filtering.order, filtering.cutoff_hz / (rate / 2))
    smooth = signal.filtfilt(numerator, denominator, position, axis=0)
    velocity = np.gradient(smooth, 1 / rate, axis=0)
    return SmoothMotion(smooth, velocity, np.gradient(velocity, 1 / rate, axis=0))


def axis_columns(motion: SmoothMotion, joint: int) -> dict[str, Array]:
    """Return the columns of a single rigid axis: inertia, viscous and Coulomb friction, offset; each shape (T,)."""
    velocity = motion.velocity[:, joint]
    return {
        "inertia": motion.acceleration[:, joint],
        "viscous": velocity,
        "coulomb": np.sign(velocity),
        "offset": np.ones_like(velocity),
    }


def model_torque(arm: Arm, rotor_inertia: Array, motion: SmoothMotion) -> Array:
    """Return the motor torque of a rigid arm without friction along a motion, shape (T, n) [Nm].

    Args:
        arm: The links.
        rotor_inertia: Shape (n,) [kg m^2], J_m N^2.
        motion: T instants.
    """
    rows = zip(motion.position, motion.velocity, motion.acceleration, strict=True)
    links = np.array([arm.inverse_dynamics(q, v, a) for q, v, a in rows])
    return np.asarray(links + rotor_inertia * motion.acceleration)


def fit_motion(columns: Mapping[str, Array], force: Array, filtering: Filtering) -> MotionFit:
    """Return the factors of the columns that explain the force best, after parallel filtering.

    Args:
        columns: Name -> shape (T,).
        force: Shape (T,) [N] or [Nm].
        filtering: Decimation.

    Raises:
        InputError: Fewer thinned samples than columns, or columns that cannot be told apart.
    """
    stacked = np.column_stack([*columns.values(), force])
    if filtering.decimation > 1:
        stacked = signal.decimate(stacked, filtering.decimation, ftype="fir", axis=0, zero_phase=True)
    stacked = stacked[EDGE : len(stacked) - EDGE]
    regressor, response = stacked[:, :-1], stacked[:, -1]
    if len(response) <= len(columns):
        raise InputError(f"{len(response)} samples after decimation for {len(columns)} parameters: record for longer.")
    parameters, _, rank, _ = np.linalg.lstsq(regressor, response)
    if rank < len(columns):
        raise InputError(f"this motion cannot tell {', '.join(columns)} apart: it needs to move both ways and faster.")
    residual = response - regressor @ parameters
    variance = residual @ residual / (len(response) - len(columns))
    spread = response - response.mean()
    return MotionFit(
        names=tuple(columns),
        parameters=parameters,
        sigma=np.sqrt(variance * np.diag(np.linalg.inv(regressor.T @ regressor))),
        relative_error=float(np.linalg.norm(residual) / np.linalg.norm(response)),
        r_squared=float(1 - residual @ residual / (spread @ spread)),
        n_samples=len(response),
    )
