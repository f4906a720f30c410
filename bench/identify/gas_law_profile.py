"""Profile likelihood of C and l_c: the minimum of a `GasLawProblem`, and how far it reaches.

M is linear in C, so for each l_c the best C is known in closed form and one dimension is left to search. It is searched
over the logarithm of the gap between l_c and the longest cylinder that was measured, which l_c exceeds.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from bench.identify.gas_law_problem import GasLawProblem
from bench.record.campaign import Array

NEAREST, FARTHEST = 1e-4, 1e3  # [m], gap that is searched; at 1 km the force is constant
GRID = 60  # points of the search before it is refined


@dataclass(frozen=True)
class Minimum:
    """Where chi-square is least.

    Attributes:
        gas_constant: C [Nm].
        critical_length: l_c [m].
        chi_square: There.
    """

    gas_constant: float
    critical_length: float
    chi_square: float


def minimum(problem: GasLawProblem) -> Minimum:
    """Return the best C and l_c."""
    chi_square = _chi_square(problem)
    grid = np.linspace(np.log(NEAREST), np.log(FARTHEST), GRID)
    best = int(np.argmin([chi_square(u) for u in grid]))
    bounds = grid[max(best - 1, 0)], grid[min(best + 1, GRID - 1)]
    found = minimize_scalar(chi_square, bounds=bounds, method="bounded", options={"xatol": 1e-9})
    critical_length = _longest(problem) + float(np.exp(found.x))
    constant, least, _ = problem.for_critical_length(critical_length)
    return Minimum(constant, critical_length, least)


def intervals(problem: GasLawProblem, best: Minimum, rise: float) -> Array:
    """Return where the profile of chi-square has risen by `rise` above its minimum.

    Returns:
        Shape (2, 2), lower and upper end of C [Nm] and of l_c [m]. Both upper ends are inf where even a constant force,
        l_c without end, cannot be excluded.
    """
    chi_square, longest = _chi_square(problem), _longest(problem)

    def left(u: float) -> float:
        return rise - (chi_square(u) - best.chi_square)

    def farthest_constant(sign: int) -> float:
        """Return the end of C over all l_c within: for each, chi-square is a parabola in C."""

        def inside(u: float) -> float:
            constant, _, curvature = problem.for_critical_length(longest + float(np.exp(u)))
            return -sign * constant - float(np.sqrt(max(left(u), 0.0) / curvature))

        found = minimize_scalar(inside, bounds=(low, high), method="bounded", options={"xatol": 1e-6})
        return -sign * float(found.fun)

    centre, nearest, farthest = (float(np.log(g)) for g in (best.critical_length - longest, NEAREST, FARTHEST))
    low = nearest if left(nearest) > 0 else brentq(left, nearest, centre, xtol=1e-9)
    high = farthest if left(farthest) > 0 else brentq(left, centre, farthest, xtol=1e-9)
    upper = (np.inf, np.inf) if high == farthest else (farthest_constant(1), longest + float(np.exp(high)))
    return np.array([[farthest_constant(-1), upper[0]], [longest + float(np.exp(low)), upper[1]]])


def _longest(problem: GasLawProblem) -> float:
    return float(problem.length.max())


def _chi_square(problem: GasLawProblem) -> Callable[[float], float]:
    longest = _longest(problem)
    return lambda u: problem.for_critical_length(longest + float(np.exp(u)))[1]
