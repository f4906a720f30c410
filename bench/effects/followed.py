"""A robot along a motion, and torques that an effect adds to it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.robot.compiled import CompiledRobot
from bench.simulate.trace import Array, Trace


@dataclass(frozen=True, eq=False)
class Followed:
    """A robot and what it did; T instants, n drives.

    Attributes:
        compiled: The robot.
        trace: What it did.
        acceleration: Shape (T, n) [rad/s^2], of motors and links.
        visit: Shape (T,), at rest the index of the first instant of the same visit, which comes right after the pose
            was approached; -1 in motion.
        first: Shape (T,), index of the first instant of the same visit or stretch of motion.
        gear_k: Shape (T, n) [K], of the gearboxes.
        since_start: Shape (T,) [s], from the start of the campaign, in the middle of what conditions hold for.
        waves: Returns the mean of exp(2 pi i x / period) over what each instant averages, shape (T,), of a period [rad]
            or [m] and the index of a drive at x; None: that of its q, for nothing is averaged.
    """

    compiled: CompiledRobot
    trace: Trace
    acceleration: Array
    visit: NDArray[np.intp]
    first: NDArray[np.intp]
    gear_k: Array
    since_start: Array
    waves: Callable[[float, int], NDArray[np.complex128]] | None = None

    def wave(self, period: float, drive: int) -> NDArray[np.complex128]:
        """Return the mean of exp(2 pi i x / period) over what each instant averages, shape (T,); see `waves`."""
        if self.waves is not None:
            return self.waves(period, drive)
        return np.asarray(np.exp(2j * np.pi / period * self.trace.q[:, drive]))


@dataclass(frozen=True, eq=False)
class Torques:
    """Torques that act on the motor and on the link of one drive, positive towards growing angle.

    Attributes:
        motor, link: Shape (T,) [Nm] or [N], or one number for all instants.
    """

    motor: Array | float = 0.0
    link: Array | float = 0.0
