"""How fast gears wind up along a motion, so that their links move otherwise than their motors.

Under the torque t on its link a gear of stiffness k winds up by d = t/k. The link, of inertia M, moves as q - d, and
its drive pays M d'' less than for a rigid gear. Along a motion of frequency f that is (f/f_0)^2 of what the inertia
takes, with f_0 the mode of the link on its gear: a tenth at a third of f_0.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgttrf, dgttrs

from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array

INTERRUPTED = 1.5  # rounding: times the usual step between bins; where it is longer, bins are left out


@dataclass(frozen=True, eq=False)
class MotionSpline:
    """Cubic splines through the bins of motions, T instants in all, as far as each goes without interruption.

    At both ends they have no second derivative. Rests, and the approach before the first bin, belong to none. All are
    solved for at once: SciPy's, made motion by motion for each world, take longer than the simulation.

    Attributes:
        step: Shape (T,) [s], from each instant to the next of its spline; 0 where it has none.
        inner: Shape (T,) bool, instants between two others of their spline.
    """

    step: Array
    inner: NDArray[np.bool_]

    @classmethod
    def through(cls, segments: Sequence[Segment]) -> Self:
        """Return those through the motions of segments, one after the other."""
        step = np.concatenate([_steps(segment) for segment in segments])
        return cls(step, (step > 0) & (np.append(0.0, step[:-1]) > 0))

    @cached_property
    def _factors(self) -> list[NDArray[Any]]:
        """The equations of second derivatives, which are tridiagonal, factorised as `dgttrs` has them."""
        before = np.append(0.0, self.step[:-1])
        upper, lower = np.where(self.inner, self.step, 0.0), np.where(self.inner, before, 0.0)
        middle = np.where(self.inner, 2 * (self.step + before), 1.0)
        return list(dgttrf(lower[1:], middle, upper[:-1])[:-1])

    def rates(self, values: Array) -> tuple[Array, Array]:
        """Return first and second derivatives over time, shape (T, n) each; zero where there is no spline.

        The second derivative of a cubic spline is too large, by (w h)^2/12 of a vibration w with steps of h. Averaged
        over its neighbours with weights 1, 10, 1 it is right to the fourth order.

        Args:
            values: Shape (T, n), T at least 3.
        """
        step, inner = self.step[:-1, None], self.inner[:, None]
        slope = np.divide(np.diff(values, axis=0), step, out=np.zeros_like(values[1:]), where=step > 0)
        turn = np.zeros_like(values)
        turn[1:-1] = np.where(inner[1:-1], 6 * np.diff(slope, axis=0), 0.0)
        bent, _ = dgttrs(*self._factors, turn)
        first = np.zeros_like(values)
        first[:-1] = slope - step * (2 * bent[:-1] + bent[1:]) / 6
        ends = np.flatnonzero((self.step[1:] == 0) & (self.step[:-1] > 0)) + 1
        first[ends] = slope[ends - 1] + step[ends - 1] * bent[ends - 1] / 6
        second = np.zeros_like(values)
        second[1:-1] = np.where(inner[1:-1], (bent[:-2] + 10 * bent[1:-1] + bent[2:]) / 12, 0.0)
        return first, second


def _steps(segment: Segment) -> Array:
    """Return the steps of a segment's splines, shape (T,) [s]."""
    steps = np.append(np.diff(segment.motion.time), 0.0)
    if segment.is_static:
        return np.zeros_like(steps)
    steps[0] = 0.0
    going = steps[steps > 0]
    return np.where(steps > INTERRUPTED * np.median(going), 0.0, steps) if len(going) else steps
