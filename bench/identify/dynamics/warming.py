"""Friction that falls from run to run, as that of drives that warm up does, whatever its course.

Of each drive, the friction that was found is scaled anew in each run, by what is left there. Where nothing goes on from
run to run, any order of the runs is as likely as any other, however much runs differ: that is an exact test (a
permutation test), which takes neither errors as normal nor drives as independent.
"""

from dataclasses import dataclass
from itertools import permutations
from math import factorial

import numpy as np
from numpy.typing import NDArray

from bench.identify.dynamics.found import FirstPass
from bench.record.campaign import Array

RUBS = ("coulomb", "viscous", "viscous_difference", "rolling", "load", "presliding")
RATE = 0.01  # declared: of recordings in which nothing goes on, as of a diagnosis; five runs have 120 orders
FASTER = 0.05  # declared: of recordings whose motions have no order by speed, either way, for which nothing is told
ORDERS = 5040  # effort: all of seven runs; of more runs as many at random
MOST = 0.5  # declared: of the mean square left of some drive, explained; what is less is not what is missing here


@dataclass(frozen=True)
class Warming:
    """Friction that fell.

    Attributes:
        joints: Names.
        runs: Names of the runs, as they came one after another.
        scale: Shape (n, K), friction of each drive in each run less what was found, as a share of that; nan for drives
            that do not move in all runs.
        explained: Shape (n,), share of what is left of each drive's torque that these scales explain.
    """

    joints: tuple[str, ...]
    runs: tuple[str, ...]
    scale: Array
    explained: Array


def warming_of(found: FirstPass) -> Warming | None:
    """Return how friction fell from run to run in the recording with most runs; None where that may be chance.

    A share of it that falls in an hour, which the first pass may have, is part of that.

    Nothing is told where motions get faster or slower all along as well, for what friction does at other speeds than a
    model has it would look the same.
    """
    recordings = [part.samples.recording for part in found.stretches]
    runs = {one: tuple(dict.fromkeys(_runs(found, one))) for one in dict.fromkeys(recordings)}
    recording, names = max(runs.items(), key=lambda item: len(item[1]))
    if factorial(len(names)) < 1 / RATE:
        return None
    number = np.array(
        [names.index(part.samples.run) if part.samples.recording == recording else -1 for part in found.stretches]
    )
    scale, speed = (np.full((found.layout.n, len(names)), np.nan) for _ in range(2))
    explained = np.full(found.layout.n, np.nan)
    stays = found.parameters.copy()
    stays[found.layout.of_drives("warming")] = 0.0
    for one in found.rows(found.stretches):
        if not len(one):
            continue
        left = one.response(found.solution.delay) - one.model(stays)
        rubs = friction_of(found, one.drive, one.index, one.constant)
        moving = np.abs(one.constant[:, one.index == parameter_of(found, "viscous", one.drive)]).ravel()
        after, run = left.copy(), number[one.stretch]
        for k in range(len(names)):
            rows = np.flatnonzero(run == k)
            if square := float(rubs[rows] @ rubs[rows]):
                scale[one.drive, k] = rubs[rows] @ left[rows] / square
                speed[one.drive, k] = np.log(np.sqrt(np.mean(moving[rows] ** 2)))
                after[rows] -= scale[one.drive, k] * rubs[rows]
        explained[one.drive] = 1 - float(after @ after) / max(float(left @ left), np.finfo(float).tiny)
    whole = np.isfinite(scale).all(axis=1) & (np.ptp(np.nan_to_num(scale), axis=1) > 0)
    if not whole.any() or _chance(-scale[whole]) > RATE or explained[whole].max() < MOST:
        return None
    if min(_chance(speed[whole]), _chance(-speed[whole])) <= FASTER:
        return None
    scale[~whole] = np.nan
    return Warming(found.joints, names, scale, explained)


def _runs(found: FirstPass, recording: str) -> list[str]:
    return [part.samples.run for part in found.stretches if part.samples.recording == recording]


def parameter_of(found: FirstPass, column: str, drive: int) -> int:
    """Return the index of a parameter of a drive, of those in `DRIVE_COLUMNS`."""
    return int(np.arange(found.layout.size)[found.layout.of_drives(column)][drive])


def friction_of(found: FirstPass, drive: int, index: NDArray[np.int64], constant: Array) -> Array:
    """Return the friction of a drive as it was found, at each of its rows [Nm] or [N]; arguments as of `DriveRows`."""
    own = np.isin(index, [parameter_of(found, column, drive) for column in RUBS])
    return np.asarray(constant[:, own] @ found.parameters[index[own]])


def _chance(values: Array) -> float:
    """Return how likely an order of the runs makes values, shape (m, K), rise as steadily as they do, or more."""
    apart = values - values.mean(axis=1, keepdims=True)
    spread = np.sqrt(np.sum(apart**2, axis=1, keepdims=True))
    shape = np.sum(apart / np.where(spread > 0, spread, 1.0), axis=0)  # of all drives, each with the same say
    count = values.shape[1]
    course = np.arange(count) - (count - 1) / 2
    if factorial(count) <= ORDERS:
        orders = np.array(list(permutations(range(count))))
        rises = shape[orders] @ course
    else:
        rng = np.random.default_rng(0)
        rises = np.array([shape[rng.permutation(count)] @ course for _ in range(ORDERS)] + [shape @ course])
    as_much = rises >= float(shape @ course) - 1e-9 * float(np.abs(shape) @ np.abs(course))  # rounding: sums of K terms
    return float(np.mean(as_much))
