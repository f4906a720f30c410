"""Where friction slides along what a robot did: the torque that grows when a level does."""

import numpy as np

from bench.effects.effect import Array
from bench.effects.followed import Followed
from bench.effects.friction_elements import Side

PLAIN = (
    1e-3  # rounding: relative; by which sliding friction may differ from the Coulomb level where nothing else shapes it
)


def sliding_friction(followed: Followed, side: Side, drive: int) -> Array | None:
    """Return the Coulomb friction of one side of a drive, shape (T,) [Nm]: minus its level in motion towards +.

    In motion it slides with the joint. The link of a joint that stands while others move slides where they push it over
    its level, and is held before that. What holds keeps the level that it had when it slid last: in the same stretch of
    motion, or at rest on the approach or under a load.

    None where it is not plain Coulomb friction, for something else shapes it.

    Args:
        followed: What the robot did.
        side: Of the elastic element.
        drive: Index.
    """
    level = float(getattr(followed.compiled, f"{side}_coulomb")[drive])
    force: Array = getattr(followed.trace, f"{side}_friction")[:, drive]
    if level == 0.0:
        return None if np.any(force) else np.zeros_like(force)
    at_rest = followed.visit >= 0
    moves = ~at_rest & (followed.trace.q_velocity[:, drive] != 0)
    slides = np.abs(force) > (1 - PLAIN) * level
    if np.any(np.abs(force) > (1 + PLAIN) * level) or not np.all(slides[moves]):
        return None
    last = np.maximum.accumulate(np.where(slides, np.arange(len(force)), -1))
    return np.where(last >= followed.first, np.sign(force[last]) * level, 0.0)
