"""Where the friction of a joint may be between its levels: it stands, is about to, or has not come far since.

A friction element is a spring until its joint has come as far as takes its force from one level to the other, however
fast; from there on it slides, however slowly, until the joint turns round. Where a joint comes to stand, friction goes
over to what it holds at rest, which is anything between its levels.
"""

import numpy as np
from numpy.typing import NDArray

from bench.effects.nominal import factor_of
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.robot.starter.defaults import PRESLIDING

STANDS = 1e-4  # rounding: [rad/s] or [m/s]; below it a joint counts as standing
SURELY = 2.0  # declared: standard deviations of the presliding stiffness that are waited for


def presliding_travel(compiled: CompiledRobot) -> Array:
    """Return after how far a joint that turned round slides again, shape (n,) [rad] or [m].

    That is 2 f_C over the stiffness with which an element holds, as well as that is known (`uncertainty.presliding`),
    and no less than for the stiffness that a robot has of which nobody stated any.
    """
    sigma = compiled.robot.figures.uncertainty.presliding
    sides = (
        (compiled.motor_coulomb, compiled.motor_presliding),
        (compiled.link_coulomb, compiled.link_presliding),
    )
    gives = [level / stiffness for level, stiffness in sides]
    longer = factor_of(SURELY * sigma, sigma) if sigma > 0 else 1.0
    return np.asarray(2 * longer * np.maximum(np.maximum(*gives), PRESLIDING))


def between_levels(angles: Array, time: Array, window: int, travel: Array) -> NDArray[np.bool_]:
    """Return at which samples the friction of a joint may be between its levels, shape (rows, n).

    Nobody knows how a joint came to where a run begins or went on from where it ends, so it may have stood there.

    Args:
        angles: Shape (rows, n) [rad] or [m].
        time: Shape (rows,) [s].
        window: Samples over which a speed is taken. As the average over them it changes its sign where the joint turns
            round, and nowhere else; a parabola through them overshoots where a joint slows down suddenly.
        travel: Shape (n,), after which friction slides, from `presliding_travel`.
    """
    rows = np.arange(len(angles))
    ahead, behind = np.minimum(rows + window // 2, rows[-1]), np.maximum(rows - window // 2, 0)
    speed = (angles[ahead] - angles[behind]) / (time[ahead] - time[behind])[:, None]
    way = np.where(np.abs(speed) < STANDS, 0.0, np.sign(speed))
    last, following = _last_turn(way, rows), _next_turn(way, rows)
    come, left = (np.abs(angles - np.take_along_axis(angles, there, axis=0)) for there in (last, following))
    lasts = np.take_along_axis(following, following, axis=0) - following  # samples; a turn has one or two without speed
    stops = (np.take_along_axis(way, following, axis=0) == 0) & (lasts >= window)
    ends = following == rows[-1]
    return np.asarray((way == 0) | (come < travel) | ((stops | ends) & (left < travel)))


def _last_turn(way: Array, rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the row at which each joint began to go as it does, shape (rows, n)."""
    turns = np.diff(way, axis=0, prepend=way[:1]) != 0
    return np.asarray(np.maximum.accumulate(np.where(turns, rows[:, None], 0), axis=0))


def _next_turn(way: Array, rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the first row at which it goes otherwise, or the last one of the run, shape (rows, n)."""
    return np.asarray(np.minimum(rows[-1] - _last_turn(way[::-1], rows)[::-1] + 1, rows[-1]))
