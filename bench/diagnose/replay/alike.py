"""When instants count as being in the same state, and passages of them as passing the same states."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from bench.diagnose.replay.instants import at_each_instant, instants_of
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array
from bench.record.moving import TRAVELS

# assumed: of the largest speed, force and payload, or of the range that a joint passes. How much coinciding instants
# have in common is estimated, so a wider tolerance makes a comparison weaker and not wrong; of blocks that are held
# out, more of a run goes with each.
ALIKE = 0.02
GREATER_PART = 0.5  # exact: of the instants of a passage


def passes_same(one: Array, other: Array | cKDTree) -> bool:
    """Whether the greater part of a passage meets the states of another one.

    Args:
        one: Shape (T, s), states in units of what counts as alike.
        other: The same, with any number of instants, or its tree.
    """
    tree = other if isinstance(other, cKDTree) else cKDTree(other)
    distance, _ = tree.query(one, p=np.inf, distance_upper_bound=1.0)
    return bool(np.mean(np.isfinite(distance)) > GREATER_PART)


def groups_of_passages(passages: Sequence[Array]) -> NDArray[np.int64]:
    """Return the group of each of P passages, shape (P,): those that pass the same states are in one.

    Args:
        passages: Shape (T, s) each, states in units of what counts as alike.
    """
    trees = [cKDTree(states) for states in passages]
    low, high = (np.array([end(states, axis=0) for states in passages]) for end in (np.min, np.max))
    meets = np.zeros((len(passages), len(passages)), dtype=bool)
    for i, states in enumerate(passages):  # of those that pass by at all
        for j in np.flatnonzero(np.all((low <= high[i] + 1) & (high >= low[i] - 1), axis=1)):
            meets[i, j] = passes_same(states, trees[j])
    return np.asarray(connected_components(csr_array(meets), directed=False)[1], dtype=np.int64)


@lru_cache(maxsize=4)
def runs_together(segments: tuple[Segment, ...]) -> dict[str, int]:
    """Return the group of each run: those that go through the same states of the machine are in one.

    Args:
        segments: Of all runs.
    """
    every, states = states_of(segments), dict[str, list[Array]]()
    for segment, rows in zip(segments, instants_of(segments), strict=True):
        states.setdefault(segment.run, []).append(every[rows])
    groups = groups_of_passages([np.concatenate(parts) for parts in states.values()])
    return dict(zip(states, groups.tolist(), strict=True))


def states_of(segments: Sequence[Segment]) -> Array:
    """Return the state of the machine at every instant in units of what counts as alike, shape (T, s).

    A state is where the motors are, how fast they go, what hangs or is bolted on, and from where it was reached.
    """
    read = [segment.motion.read for segment in segments]
    q = np.concatenate([segment.motion.q[here] for segment, here in zip(segments, read, strict=True)])
    velocity = np.concatenate([segment.motion.velocity[here] for segment, here in zip(segments, read, strict=True)])
    wrench = np.concatenate([segment.motion.wrench[here] for segment, here in zip(segments, read, strict=True)])
    payload = at_each_instant(segments, [segment.conditions.payload_kg for segment in segments])
    came = np.concatenate([_came(segment) for segment in segments])
    force, moment = (np.max(np.abs(part)) for part in (wrench[:, :3], wrench[:, 3:]))
    scaled = [
        q / TRAVELS,
        _scaled(velocity, np.max(np.abs(velocity), axis=0)),
        _scaled(wrench[:, :3], force),
        _scaled(wrench[:, 3:], moment),
        _scaled(payload[:, None], np.max(payload)),
        came,
    ]
    return np.concatenate(scaled, axis=1)


def _came(segment: Segment) -> Array:
    """Return from where the state of every instant was reached, shape (T, n + 1): joints, and the load at rest."""
    read = segment.motion.read
    count = len(segment)
    if not segment.is_static:
        return np.zeros((count, segment.motion.q.shape[1] + 1))
    approach = np.sign(segment.motion.q[read][0] - segment.motion.q[0])
    force = np.linalg.norm(segment.motion.wrench[:, :3], axis=1)
    loading = np.sign(np.diff(force, prepend=force[0]))[read]
    return 2.0 * np.column_stack([np.tile(approach, (count, 1)), loading])


def _scaled(values: Array, largest: Array | float) -> Array:
    return np.asarray(values / np.where(np.asarray(largest) > 0, ALIKE * np.asarray(largest), 1.0), dtype=np.float64)
