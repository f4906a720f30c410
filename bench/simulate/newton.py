"""Newton's method for balances with kinks: play, slip, soft middles, and compliances one behind the other."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from bench.errors import ConvergenceError

Array = NDArray[np.float64]

MAX_ITERATIONS = 100
# [rad]; the first is short, and gives slopes right to 1 Nm/rad of torques near 1e4 Nm; the others reach beyond play
DIFFERENCES = (1e-8, 1e-5, 1e-4, 1e-3, 1e-2)
LONGEST_STEP = 0.02  # [rad]
FLAT = 0.01  # of the stiffness; a slope below it is that of gravity within play, which may point anywhere
HALVINGS = 12
STALLED = 0.9  # of the largest residual that a step leaves, above which slopes say nothing of where the balance is
RESOLUTION = 1e-15  # [rad]


def find_balance(residual: Callable[[Array], Array], start: Array, stiffness: Array, tolerance: float) -> Array:
    """Return where all residuals are zero, shape (u,).

    The slopes are measured by differences at each step, on the side to which the residual pushes, and a step is halved
    until the largest residual falls (or, where nothing helps, taken: beyond a kink it may have to rise first).

    Args:
        residual: From positions, shape (u,) [rad], to what is left on them, shape (u,) [Nm], positive towards growing.
        start: Shape (u,) [rad].
        stiffness: Shape (u,) [Nm/rad], of the springs there, without play.
        tolerance: On every residual [Nm].

    Raises:
        ConvergenceError: It was not reached.
    """
    x, left = start.copy(), residual(start)
    for _ in range(MAX_ITERATIONS):
        if np.max(np.abs(left)) < tolerance:
            return x
        slopes = np.stack([_slope(residual, x, left, i, FLAT * stiffness[i]) for i in range(len(x))], axis=1)
        way = np.asarray(np.linalg.solve(slopes, left), dtype=np.float64)
        way *= min(1.0, LONGEST_STEP / max(float(np.max(np.abs(way))), LONGEST_STEP))
        size = float(np.max(np.abs(left)))
        x, left = _shortened(residual, x, left, way)
        if np.max(np.abs(left)) > STALLED * size:
            x, left = _to_the_flank(residual, x, left)
    raise ConvergenceError(
        f"no equilibrium within {MAX_ITERATIONS} iterations: {np.max(np.abs(left)):.3g} Nm are left, "
        f"{tolerance:g} Nm were asked for; is the load far above the rating?"
    )


def _shortened(residual: Callable[[Array], Array], x: Array, left: Array, step: Array) -> tuple[Array, Array]:
    size = float(np.max(np.abs(left)))
    whole = x + step, residual(x + step)
    share = 1.0
    tried = whole
    for _ in range(HALVINGS):
        if np.max(np.abs(tried[1])) < size:
            return tried
        share /= 2
        tried = x + share * step, residual(x + share * step)
    return whole


def _to_the_flank(residual: Callable[[Array], Array], x: Array, left: Array) -> tuple[Array, Array]:
    """Move the unknown with the largest residual alone to where it is zero, through a gap in which it hardly falls."""
    i = int(np.argmax(np.abs(left)))

    def moved(way: float) -> Array:
        beside = x.copy()
        beside[i] += way
        return beside

    for difference in DIFFERENCES:
        way = float(np.copysign(difference, left[i]))
        if residual(moved(way))[i] * left[i] < 0:
            root = brentq(lambda step: float(residual(moved(step))[i]), 0.0, way, xtol=RESOLUTION)
            return moved(root), residual(moved(root))
    return x, left


def _slope(residual: Callable[[Array], Array], x: Array, left: Array, i: int, least: float) -> Array:
    """Return by how much all residuals fall per step of one unknown, over a way that is long enough to see a spring."""
    slope = np.zeros_like(x)
    for difference in DIFFERENCES:
        beside, step = x.copy(), float(np.copysign(difference, left[i]))
        beside[i] += step
        slope = (left - residual(beside)) / step
        if slope[i] > least:
            break
    return slope
