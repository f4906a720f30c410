"""Gravity that does not point as the model has it: a base out of level, which no term of the linear model has.

To first order in how far it leans, x = (x_1, x_2) [rad], gravity is g + |g| (x_1 e_1 + x_2 e_2) with two directions
across it, and each drive feels what the links that were found weigh in these directions. An upright first axis feels
nothing of gravity else. Everything else of the model gives way as it can, so what a lean explains is beyond that.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.identify.arm import Arm
from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.found_arm import found_arm
from bench.identify.dynamics.normal import Weighed, normal_of, posterior
from bench.record.campaign import Array
from bench.robot.bodies import read_only

# declared: of the mean square that is left of a drive, as of motors that turn with two joints. Two columns explain as
# much of N independent readings by chance where N is below twenty
MOST = 0.5
ROUNDS = 2  # effort: a lean that is not fitted is noise at first; once it is known, drives count by what else is left
LEFT = 1e-6  # rounding: the least share that may be left
LOWEST = 1e-12  # rounding: of what columns weigh, when what the model does as well is taken away


@dataclass(frozen=True)
class Leaning:
    """Gravity that seems to lean.

    Attributes:
        gravity: Shape (3,) [m/s^2], in the base's frame.
        lean: By how much it leans against the model's [rad].
        sigma: Standard deviation of that [rad].
        explained: Joint -> share of the mean square that is left of its torque, where that is most of it.
    """

    gravity: Array
    lean: float
    sigma: float
    explained: dict[str, float]


def leaning_of(found: FirstPass) -> Leaning | None:
    """Return how gravity seems to lean, where that explains most of what the first pass leaves of a drive."""
    solution, gravity = found.solution, np.array(found.nominal.bodies.gravity, dtype=np.float64)
    size = float(np.linalg.norm(gravity))
    if not size > 0:
        return None
    across = size * np.linalg.svd(gravity[None, :])[2][1:]
    every = _weights(found, across)
    drives = [one for one in solution.drives if one.weight > 0 and len(one.rows)]
    columns = [_of_rows(one, every) for one in drives]
    left = [one.rows.response(solution.delay) - one.rows.model(solution.parameters) for one in drives]
    before = np.array([np.sum(rest**2) for rest in left])
    pull = _asked(drives, left, found.layout.size)  # of the prior, which what is left of the data balances
    for _ in range(ROUNDS):
        covariance = posterior(normal_of(drives, solution.delay, found.layout.size), found.prior, solution.widths)[1]
        shared, told, asked = np.zeros((found.layout.size, 2)), np.zeros((2, 2)), np.zeros(2)
        for one, more, rest in zip(drives, columns, left, strict=True):
            shared[one.rows.index] += one.weight * one.factors.T @ more
            told += one.weight * more.T @ more
            asked += one.weight * more.T @ rest
        alone, told = float(np.trace(told)), told - shared.T @ covariance @ shared
        if not np.linalg.eigvalsh(told)[0] > LOWEST * alone:
            return None
        more_of = _asked(drives, left, found.layout.size) - pull
        lean = np.linalg.solve(told, asked - shared.T @ covariance @ more_of)
        gives = covariance @ (more_of - shared @ lean)  # what else gives way
        rows = zip(drives, columns, left, strict=True)
        after = [np.sum((rest - more @ lean - one.factors @ gives[one.rows.index]) ** 2) for one, more, rest in rows]
        share = 1 - np.array(after) / np.maximum(before, np.finfo(float).tiny)
        drives = [replace(one, weight=one.weight / max(1 - x, LEFT)) for one, x in zip(drives, share, strict=True)]
    explained = {found.joints[one.rows.drive]: float(x) for one, x in zip(drives, share, strict=True) if x > MOST}
    if not explained:
        return None
    by = float(np.linalg.norm(lean))
    sigma = float(np.sqrt(lean @ np.linalg.solve(told, lean))) / by
    return Leaning(gravity + lean @ across, by, sigma, explained)


def _weights(found: FirstPass, across: Array) -> list[Array]:
    """Return for each stretch what the links weigh if gravity points in some directions, shape (T, n, 2) [Nm]."""
    links = found_arm(found.nominal, found.arm, found.layout, found.parameters)
    every = []
    for part in found.stretches:
        bodies = links.carrying(part.samples.recording).bodies
        arms = [Arm(replace(bodies, gravity=read_only(direction))) for direction in across]
        every.append(np.stack([arm.gravity(part.position) for arm in arms], axis=2))
    return every


def _asked(drives: Sequence[Weighed], left: Sequence[Array], size: int) -> Array:
    """Return X^T W y of what is left, shape (p,)."""
    asked = np.zeros(size)
    for one, rest in zip(drives, left, strict=True):
        asked[one.rows.index] += one.weight * one.factors.T @ rest
    return asked


def _of_rows(one: Weighed, every: Sequence[Array]) -> Array:
    """Return what the links weigh at the rows of a drive, shape (R, 2) [Nm]."""
    rows = one.rows
    return np.concatenate([part[rows.instant[rows.stretch == k], rows.drive] for k, part in enumerate(every)])
