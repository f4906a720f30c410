"""When instants count as being in the same state, and passages of them as passing the same states."""

import numpy as np
from scipy.spatial import cKDTree

from bench.record.campaign import Array

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
