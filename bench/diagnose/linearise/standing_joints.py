"""How much of its friction a joint that stands takes anew from instant to instant, while others move.

A standing joint holds what the path left it, and lets go of it slowly as loads change; what shakes the arm makes that
jump. Jumps are rough, and models are smooth over the bins of a motion: so their size follows from the second
differences of a residual, whatever else the model misses.
"""

from collections.abc import Sequence

import numpy as np

from bench.diagnose.linearise.torque_response import TorqueResponse
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

# exact: of the friction that a joint may hold, both ways: its share where it could be anywhere each time
ANYWHERE = 12**-0.5
# effort: that are tried; two levels are all that it may hold
SHARES = np.append(0.0, np.geomspace(1e-3, 2 * ANYWHERE, 40))
WEIGHTS = np.array([1.0, 4.0, 1.0])  # exact: squares of a second difference's coefficients
FEW = 30  # declared: differences, which tell their own size to a seventh


def shaken_share(
    compiled: CompiledRobot,
    segments: Sequence[Segment],
    responses: Sequence[TorqueResponse],
    quantities: Sequence[Quantity],
    residuals: Sequence[Array],
) -> float:
    """Return the standard deviation of the jumps, as a share of a joint's Coulomb level; one for all joints.

    It is the value with the largest likelihood of the second differences of all channels that feel links. Where there
    are too few of them, it is that of a joint that is anywhere between its levels at every instant.

    Args:
        compiled: The robot.
        segments: Of the campaign.
        responses: Of their readings to torques.
        quantities: What is compared.
        residuals: Of each segment, shape (T, c).
    """
    of_links = np.array([not quantity.is_drive for quantity in quantities])
    levels = np.concatenate([compiled.link_coulomb, compiled.motor_coulomb])
    found: list[list[Array]] = [[], [], []]
    for segment, response, left in zip(segments, responses, residuals, strict=True):
        if segment.is_static or len(segment) < len(WEIGHTS):
            continue
        spread = np.concatenate([response.link, response.motor], axis=2) * levels * np.tile(segment.standing, 2)
        variance = np.sum(spread**2, axis=2)
        parts = [left[2:] - 2 * left[1:-1] + left[:-2]]
        parts += [sum(w * v[i : len(v) - 2 + i] for i, w in enumerate(WEIGHTS)) for v in (segment.sigma**2, variance)]
        known = np.all(np.isfinite(parts), axis=0) & of_links & (parts[2] > 0)
        for all_so_far, part in zip(found, parts, strict=True):
            all_so_far.append(part[known])
    second, noise, jump = (np.concatenate([np.empty(0), *one]) for one in found)
    if len(second) < FEW:
        return float(2 * ANYWHERE)
    variances = noise + SHARES[:, None] ** 2 * jump
    likelihood = -0.5 * np.sum(second**2 / variances + np.log(variances), axis=1)
    return float(SHARES[np.argmax(likelihood)])
