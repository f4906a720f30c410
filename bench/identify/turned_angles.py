"""Which angles count the other way round than the model's, by the torque that drives report.

First by the shape of the torque alone, each drive with a free offset: that is safe where springs or hoses that no file
has hold a part of the load. Directions that explain as much are then held against what does not change its sign with
them: friction takes energy whichever way a drive moves, rotors have inertia, and a reading is off by no more than is
stated. A slide whose weight another offset would have to hold up is turned, if friction cannot hold it either; nothing
but that tells its direction where axes are upright, for everything else about it is even. No joint is turned out of its
range that stays within it as it is: what asks for that is something that no file has, or a zero that is elsewhere.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear, minimize_scalar

from bench.identify.directions import Flags, directions, kept_by_range
from bench.identify.drive_model import TINY, LinksAlong, Motion, best_payload, carrying, misfit, model_columns, solved
from bench.record.campaign import Array
from bench.robot.nominal_dynamics import NominalDynamics

HALF = 0.5  # of what is unexplained: signs are turned only where that is left (assumed; symmetric signs leave all)
SAMPLES = 400  # with which signs are tried
NINETY_NINE = 2.576  # exact: standard deviations to either side that hold 99 %
ROUGHLY = 0.05  # of the largest payload, to which one is searched where signs are compared (effort)
ROUNDING = 1e-9  # of a reading's size: the least offset that it may have


@dataclass(frozen=True)
class TurnedAngles:
    """Directions of n drives.

    Attributes:
        turned: Shape (n,), whether an angle counts the other way round than in the model.
        unsure: Shape (n,), whether its direction is not told: with some drives the other way round, torques are
            explained as well. An arm and its mirror image need the same torques.
        alone: Shape (n,), those of them that need the same when they alone are turned.
        beyond: Shape (n,), not turned, though torques are explained far better so: they would be beyond their range.
    """

    turned: Flags
    unsure: Flags
    alone: Flags
    beyond: Flags


def turned_angles(nominal: NominalDynamics, time: Array, position: Array, reading: Array, read: Flags) -> TurnedAngles:
    """Return which angles have to be turned, and of which it is not told.

    None is turned where that explains no more than half of what is left; directions that explain no more than twice as
    badly are not told apart. Of as many turns the best counts; more turns have to leave half of what fewer leave.

    Args:
        nominal: The robot.
        time: Shape (T,) [s], even.
        position: Shape (T, n) [rad] or [m].
        reading: Shape (T, k), of the drives that are read.
        read: Shape (n,), which these are.
    """
    every = max(1, len(time) // SAMPLES)
    motion, seen = Motion.along(time, position), reading[::every]
    tried = directions(position.shape[1])
    turned = (LinksAlong.of(nominal, motion.seen(np.where(t, -1.0, 1.0), every)) for t in tried)
    columns = [model_columns(nominal, along)[read] for along in turned]
    free = [float(np.log(max(np.sum(_misfit(one, seen, nominal.payload)), TINY))) for one in columns]
    offset = NINETY_NINE * nominal.torque_offset_sigma[read]

    def found(places: list[int]) -> tuple[Flags, list[Flags]]:
        """Return the best of some directions, and those that are not told apart from it, itself among them."""
        alike = [places[k] for k in _alike([tried[k] for k in places], [free[k] for k in places])]
        physical = [_physical_misfit(columns[k], seen, nominal.payload, offset) for k in alike]
        flags = [tried[k] for k in alike]
        return flags[_best(flags, physical)], [flags[k] for k in _alike(flags, physical)]

    kept = kept_by_range(nominal.bodies.limits, position)
    best, alike = found(list(range(len(tried))))
    beyond = best & kept
    if np.any(beyond):
        best, alike = found([k for k, one in enumerate(tried) if not np.any(one & kept)])
    others = [one != best for one in alike]
    alone = [other for other in others if np.sum(other) == 1]
    return TurnedAngles(best, np.any(others, axis=0), np.any([best & False, *alone], axis=0), beyond)


def _best(tried: list[Flags], misfits: list[float]) -> int:
    """Return the place of the best directions, by logarithms of what is left; fewer turns first."""
    best = 0
    for k in range(1, len(tried)):
        as_many = np.sum(tried[k]) == np.sum(tried[best])
        if misfits[k] < misfits[best] + (0.0 if as_many else np.log(HALF)):
            best = k
    return best


def _alike(tried: list[Flags], misfits: list[float]) -> list[int]:
    """Return the places of directions that are not told apart from the best, fewer turns first."""
    least = misfits[_best(tried, misfits)]
    return [k for k, left in enumerate(misfits) if left + np.log(HALF) <= least]


def _misfit(columns: Array, reading: Array, heaviest: float) -> Array:
    return misfit(carrying(columns, best_payload(columns, reading, heaviest)), reading)


def _physical_misfit(columns: Array, reading: Array, heaviest: float, offset: Array) -> float:
    """Return what is left of readings if friction and offsets are what they can be.

    It is the logarithm of the share of the variance, summed over drives: the likelihood, each drive with its own noise.
    A drive that is explained badly does not hide another one so.

    Args:
        columns: Shape (k, T, c), as of `model_columns`.
        reading: Shape (T, k).
        heaviest: Largest payload [kg].
        offset: Shape (k,), largest offset of each reading [Nm].
    """

    def left(payload: float) -> float:
        carried = carrying(columns, payload)
        slope = np.abs(solved(carried, reading)[:, 0])
        shares = map(_physical_share, carried, reading.T, slope * offset)
        return float(np.sum(np.log(np.maximum(list(shares), TINY))))

    if heaviest <= 0:
        return left(0.0)
    found = minimize_scalar(left, bounds=(0.0, heaviest), options={"xatol": ROUGHLY * heaviest})
    return float(min(found.fun, left(0.0)))


def _physical_share(columns: Array, reading: Array, offset: float) -> float:
    """Return the share of one reading that is left, the better of both signs of it.

    Friction of either direction and a rotor that nobody knows are not negative; viscous friction may be, for friction
    falls with speed.

    Args:
        columns: Shape (T, c), of one drive: its torque, speed, direction, one, acceleration if its rotor is free.
        reading: Shape (T,).
        offset: Largest one of the reading, in its unit.
    """
    torque, speed, direction, one, *rotor = columns.T
    forth, back = np.maximum(direction, 0.0), np.minimum(direction, 0.0)
    design = np.stack([speed, one, torque, forth, back, *rotor], axis=1)
    q, r = np.linalg.qr(design)
    most = max(offset, ROUNDING * float(np.max(np.abs(reading))), TINY)
    lower = np.array([-np.inf, -most, *np.zeros(3 + len(rotor))])
    upper = np.array([np.inf, most, *np.full(3 + len(rotor), np.inf)])
    size, seen = float(reading @ reading), q.T @ reading
    fits = [lsq_linear(r, sign * seen, (lower, upper), method="bvls") for sign in (1.0, -1.0)]
    least = min(2 * float(fit.cost) for fit in fits)
    left = least + max(0.0, size - float(seen @ seen))
    return left / max(len(reading) * float(np.var(reading)), TINY)
