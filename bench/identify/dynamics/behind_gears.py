"""Torques without friction of the drives: those of sensors behind the gears, or from which friction was taken."""

import numpy as np

from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.warming import friction_of, parameter_of

# declared: of a drive's torque, root mean squares. Friction is 0.29 to 1.12 of it in the KR300 (recording A), 0.33 to
# 0.96 in a stranger's seven drives, and less than 0.006 by sensors behind their gears
LEAST_FRICTION = 0.05
FEWEST = 2  # declared: drives that move, all of them so: one alone may be a direct drive


def friction_share(found: FirstPass) -> float | None:
    """Return the largest share of its torque that any drive may pay for friction, where all pay next to nothing.

    None where a drive may pay more, as motors do, or where fewer than two move.
    """
    shares = []
    for one in found.rows(found.stretches):
        if not len(one):
            continue
        level = parameter_of(found, "coulomb", one.drive)
        rubs = friction_of(found, one.drive, one.index, one.constant)
        torque = one.response(found.solution.delay) + one.known
        most = np.sqrt(np.mean(rubs**2)) + 2 * np.sqrt(found.solution.covariance[level, level])
        shares.append(float(most / max(np.sqrt(np.mean(torque**2)), np.finfo(float).tiny)))
    largest = max(shares, default=1.0)
    return largest if len(shares) >= FEWEST and largest < LEAST_FRICTION else None
