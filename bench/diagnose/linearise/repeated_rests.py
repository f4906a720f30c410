"""Friction at rest that repeats: a pose that is reached and loaded as it was before finds links where they lay then.

What a replay does not know of friction at rest is scatter (`noise_covariance.py`), and what it does not know of two
visits that repeat each other is partly the same: a second recording does not average it away. How large that part is
follows from how much the visits differ. Counted as new each time, it came out as an error of the readings under force
in four of five pairs of sound recordings.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bench.diagnose.linearise.common_modes import left_modes, modes_of, put_back, take_out
from bench.diagnose.linearise.noise_covariance import (
    Scatter,
    Whitening,
    begins_of,
    measured_in,
    of_links,
    rest_friction,
    whitening_of,
)
from bench.diagnose.linearise.rattling import PLACED
from bench.diagnose.linearise.standing_joints import FEW
from bench.diagnose.linearise.torque_response import TorqueResponse
from bench.diagnose.replay.alike import ALIKE
from bench.diagnose.replay.play import is_loose
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array
from bench.record.moving import TRAVELS
from bench.robot.compiled import CompiledRobot

SHARES = np.linspace(0.0, 0.99, 34)  # effort: of the variance, that are tried
ANYTHING = 0.5  # exact: the mean of a share that may be anything between none and all
MOST_RESTS = 40  # effort: of a visit; one with more counts as new each time, for memory
RIDGE = 1e-12  # rounding: of the largest friction, for readings that are no noise's


@dataclass(frozen=True, eq=False)
class RepeatedRests:
    """What visits that repeat each other have in common, in the whitened space of each.

    Attributes:
        segments: Indices of the visits.
        rows: Shape (m,), their whitened readings among all.
        modes: Shape (m, r), orthonormal.
        shrink: Shape (r,), by how much each mode is taken back.
    """

    segments: tuple[int, ...]
    rows: NDArray[np.intp]
    modes: Array
    shrink: Array

    def settle(self, white: Array) -> None:
        """Take what is common out of values, shape (every m, k), that were whitened segment by segment, in place."""
        mine = white[self.rows]
        take_out(mine, self.modes, self.shrink)
        white[self.rows] = mine

    def undo(self, white: Array) -> None:
        """Put it back."""
        mine = white[self.rows]
        put_back(mine, self.modes, self.shrink)
        white[self.rows] = mine


def repeating_visits(segments: Sequence[Segment]) -> tuple[tuple[int, ...], ...]:
    """Return the visits of the same pose, reached and loaded in the same way: indices of each set of several."""
    found = []
    visits = {i: segment for i, segment in enumerate(segments) if segment.is_static and len(segment) <= MOST_RESTS}
    force = max((float(np.max(np.abs(visit.motion.wrench))) for visit in visits.values()), default=0.0)
    payload = max((visit.conditions.payload_kg for visit in visits.values()), default=0.0)
    for length in sorted({len(visit.motion) for visit in visits.values()}):
        mine = [i for i, visit in visits.items() if len(visit.motion) == length]
        states = np.array([_state(visits[i], force or 1.0, payload or 1.0) for i in mine])
        left, tree = dict.fromkeys(range(len(mine))), cKDTree(states)
        while left:
            near = tree.query_ball_point(states[next(iter(left))], 1.0, p=np.inf)
            same = [k for k in sorted(near) if k in left]
            for k in same:
                del left[k]
            if len(same) > 1:
                found.append(tuple(mine[k] for k in same))
    return tuple(found)


def _state(visit: Segment, force: float, payload: float) -> Array:
    """Return where a visit came from, went and was loaded, in units of what counts as alike."""
    motion = visit.motion
    parts = (motion.q / TRAVELS, motion.wrench / (ALIKE * force), [visit.conditions.payload_kg / (ALIKE * payload)])
    return np.concatenate([np.ravel(part) for part in parts])


def repeating_share(
    compiled: CompiledRobot,
    segments: Sequence[Segment],
    responses: Sequence[TorqueResponse],
    quantities: tuple[Quantity, ...],
    scatter: Scatter,
    residuals: Sequence[Array],
) -> float:
    """Return the share of the variance of friction at rest that repeats with a visit; none where no visit does.

    It is the value with the largest likelihood of the differences between visits that repeat each other. Where there
    are too few of them, it may be anything.

    Args:
        compiled: The robot.
        segments: Of the campaign.
        responses: Of their readings to torques.
        quantities: What is compared.
        scatter: Of friction and play.
        residuals: Of each segment, shape (T, c).
    """
    likelihood, count = np.zeros(len(SHARES)), 0
    sets = repeating_visits(segments)
    for one, other in (pair for visits in sets for pair in itertools.pairwise(visits)):
        both = measured_in(segments[one], quantities) & measured_in(segments[other], quantities)
        parts = [_part(compiled, segments[i], responses[i], quantities, scatter)[both] for i in (one, other)]
        friction = np.concatenate(parts, axis=1)
        noise = segments[one].sigma[both] ** 2 + segments[other].sigma[both] ** 2
        noise += RIDGE * float(np.max(np.sum(friction**2, axis=1), initial=0.0))
        if not (len(noise) and np.all(noise > 0)):
            continue
        deviation = np.sqrt(noise)
        modes, size = left_modes(friction / deviation[:, None])
        difference = modes.T @ ((residuals[other] - residuals[one])[both] / deviation)
        variance = 1 + (1 - SHARES[:, None]) * size**2  # beside the modes, the share changes nothing
        likelihood -= 0.5 * np.sum(difference**2 / variance + np.log(variance), axis=1)
        count += len(noise)
    if not sets:
        return 0.0
    return float(SHARES[np.argmax(likelihood)]) if count >= FEW else ANYTHING


def whitenings_of(
    compiled: CompiledRobot,
    segments: Sequence[Segment],
    responses: Sequence[TorqueResponse],
    quantities: tuple[Quantity, ...],
    scatter: Scatter,
) -> tuple[tuple[Whitening, ...], tuple[RepeatedRests, ...]]:
    """Return how each segment is whitened, and what visits that repeat each other have in common after that."""
    sets = repeating_visits(segments) if scatter.repeats > 0 else ()
    repeated = {i for visits in sets for i in visits}
    own = replace(scatter, new=scatter.new * np.sqrt(1 - scatter.repeats))
    whitenings = tuple(
        whitening_of(compiled, segment, response, quantities, own if i in repeated else scatter)
        for i, (segment, response) in enumerate(zip(segments, responses, strict=True))
    )
    edges = np.cumsum([0, *(len(whitening.modes) for whitening in whitenings)])
    found = []
    for visits in sets:
        parts = []
        for i in visits:
            part = np.sqrt(scatter.repeats) * _part(compiled, segments[i], responses[i], quantities, scatter)
            parts.append(whitenings[i](part))
        modes, shrink = modes_of(np.concatenate(parts))
        rows = np.concatenate([np.arange(edges[i], edges[i + 1]) for i in visits])
        if len(shrink):
            found.append(RepeatedRests(visits, rows, modes, shrink))
    return whitenings, tuple(found)


def _part(
    compiled: CompiledRobot,
    segment: Segment,
    response: TorqueResponse,
    quantities: tuple[Quantity, ...],
    scatter: Scatter,
) -> Array:
    """Return what friction and play at rest change, shape (T, c, k), each column with a deviation of one.

    A loose link lies where it came to rest first, as friction is as it was left: a column for each rest where that may
    have been.
    """
    once, lasting = rest_friction(compiled, segment, response, quantities, scatter)
    length, c, k = once.shape
    each = np.zeros((length, c, length, k))
    each[np.arange(length), :, np.arange(length)] = once
    parts = [each.reshape(length, c, length * k), lasting]
    loose = is_loose(compiled, response.link_load)
    gaps = of_links(compiled, response, measured_in(segment, quantities), quantities) * scatter.play
    for j in np.flatnonzero(scatter.play):
        here = begins_of(loose[:, j])[:, None] == np.arange(length)
        parts.append(PLACED * scatter.new * gaps[:, :, [j]] * here[:, None])
    return np.concatenate(parts, axis=2)
