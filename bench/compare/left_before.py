"""How far the robot that changes are linear about is from what was recorded before: no name is better than that robot.

What changed has no part in it. What stayed cancels where recordings have one motion in common, however wrong the robot
is; what a change would look like does not.
"""

from dataclasses import replace

import numpy as np

from bench.compare.as_it_was import FITS
from bench.compare.comparison import LeftBefore
from bench.compare.joint import Joint
from bench.diagnose.cross_validation.floor import floor_variance
from bench.diagnose.linearise.marginal import Nuisances
from bench.diagnose.linearise.other_noise import with_scatter


def left_before(joint: Joint) -> tuple[LeftBefore, ...]:
    """Return the channels of which the robot leaves more than `FITS` times what a right model would, the worst first.

    To every recording before all is fitted that may be off in the robot and in the readings, nothing else. Friction at
    rest counts as new each time, as in a diagnosis: that it repeats is no merit of the robot.

    Args:
        joint: All recordings.
    """
    linear = with_scatter(joint.linear, replace(joint.linear.scatter, new=1.0))
    of_row, of_instant = joint.of_row, joint.of_instant
    square = linear.residual**2
    is_before = np.zeros(len(of_instant), dtype=bool)
    for k, recording in enumerate(joint.recordings):
        if not recording.is_after:
            rows, instants = of_row == k, of_instant == k
            found = Nuisances(linear.jacobian[rows]).most_probable(linear.white[rows])
            square[instants] = (linear.residual[instants] - linear.sensitivities[instants] @ found) ** 2
            is_before |= instants
    variance = floor_variance(linear)
    missed = []
    for c, quantity in enumerate(linear.quantities):
        seen = is_before & np.isfinite(square[:, c]) & np.isfinite(variance[:, c]) & (variance[:, c] > 0)
        times = float(np.sqrt(np.mean(square[seen, c] / variance[seen, c]))) if np.any(seen) else 0.0
        if times > FITS:
            missed.append(LeftBefore(quantity.column, times))
    return tuple(sorted(missed, key=lambda one: -one.times))
