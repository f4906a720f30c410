"""Motors that turn with two joints, as at the wrists of many arms: no term of the linear model has them.

A motor at the elbow whose shaft runs through joint 5 turns by q_6 + c q_5, and so does its friction: what is left of
its torque goes with sign(v_6 + c v_5), which neither joint alone has.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.rows import DriveRows
from bench.record.campaign import Array

# effort: turns of the motor with the other joint, to one with its own, as looked for at first
FIRST = (-1.0, -0.5, 0.5, 1.0)
# effort: beside the best of them; the sign of a sum is much the same for ratios that are nearer than the steps
NEARER = np.arange(-3, 4) / 8
# declared: of the mean square that both joints' own friction and inertia leave, as of friction that warms up. The best
# of some hundred columns explains as much of N independent readings by chance where N is below twenty
MOST = 0.5


@dataclass(frozen=True)
class Coupled:
    """A motor that seems to turn with two joints.

    Attributes:
        joint: The joint that it drives.
        other: The joint that turns it as well.
        ratio: Turns of the motor with the other joint, to one with its own.
        explained: Share of the mean square that is left of its torque beside friction and inertia of both joints.
    """

    joint: str
    other: str
    ratio: float
    explained: float


def coupled_motors(found: FirstPass) -> tuple[Coupled, ...]:
    """Return the motors of which friction with two joints explains most of what the first pass leaves."""
    moves = [found.band.smooth(part.samples)[1:] for part in found.stretches]
    best = (_best(found, one, moves) for one in found.rows(found.stretches) if len(one))
    return tuple(one for one in best if one is not None and one.explained > MOST)


def _best(found: FirstPass, one: DriveRows, moves: Sequence[tuple[Array, Array]]) -> Coupled | None:
    """Return how a drive is most likely coupled, with what that explains; None where no other joint moves."""
    drive, left = one.drive, one.response(found.solution.delay) - one.model(found.parameters)

    def at_rows(columns: Sequence[Array]) -> Array:
        """Return columns of each stretch, shape (T, k), filtered and at the drive's rows, shape (R, k)."""
        thinned = [found.band.filtered(x, part.samples) for x, part in zip(columns, found.stretches, strict=True)]
        return np.concatenate([x[one.instant[one.stretch == k]] for k, x in enumerate(thinned)])

    def explained(other: int, ratio: float, beside: Array) -> float:
        more = at_rows([np.sign(v[:, drive] + ratio * v[:, other])[:, None] for v, _ in moves])
        size = np.linalg.lstsq(np.hstack([beside, more]), left, rcond=None)[0]
        without = float(np.sum(_rest(beside, left) ** 2))
        rest = float(np.sum((left - np.hstack([beside, more]) @ size) ** 2))
        return 1 - rest / without if size[-1] > 0 and without > 0 else 0.0  # friction does not push

    tried: list[tuple[float, int, float]] = []
    for other in range(found.layout.n):
        if other == drive or not found.top_speed[other]:
            continue
        both = [drive, other]
        beside = at_rows([np.hstack([np.sign(v[:, both]), v[:, both], a[:, both]]) for v, a in moves])
        tried += [(explained(other, ratio, beside), other, ratio) for ratio in FIRST]
        top = max(tried)
        if top[1] == other and top[0] > MOST:
            tried += [(explained(other, top[2] + step, beside), other, top[2] + step) for step in NEARER]
    if not tried:
        return None
    share, other, ratio = max(tried)
    return Coupled(found.joints[drive], found.joints[other], ratio, share)


def _rest(columns: Array, values: Array) -> Array:
    return np.asarray(values - columns @ np.linalg.lstsq(columns, values, rcond=None)[0])
