"""Links that cross the play of their gears and bounce: what no replay knows of where they are then."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.linearise.torque_response import TorqueResponse
from bench.diagnose.replay.motion_segments import DAMPING_RATIO
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot

# exact: of a gap: where a loose link rests, and at the instant nearest to a crossing, it may be anywhere within it
PLACED = 12**-0.5
# exact: of a gap, anew at every instant, when a link bounces at a flank that hardly any torque holds it to: anywhere
# between the flanks, counted from that one
ANYWHERE = 3**-0.5
LIGHT = 0.3  # assumed: of the torque that twists a gear by its gap; more holds links to the flank
NEAR = 0.5  # exact: of the change of torque in which a crossing lies: no more at the nearer of both instants
SAME_GAP, SAME_BOUNCE = 0.1, 0.2  # rounding: relative; changes that change hardly any scatter
TINY = 1e-300  # rounding: so that nothing is divided by zero


@dataclass(frozen=True, eq=False)
class Play:
    """The play of gears, and how high links bounce in it.

    Attributes:
        gaps: Shape (n,) [rad] or [m].
        bounce: Root mean square of how far a link is off its flank when it bounces as high as the gap is wide, as a
            share of the gap (`bounce_height.py`).
    """

    gaps: Array
    bounce: float = ANYWHERE

    def scatters_as(self, other: "Play") -> bool:
        """Whether links scatter alike in both."""
        one, two = self.gaps, other.gaps
        same = bool(np.all(np.abs(one - two) <= SAME_GAP * np.maximum(one, two)))
        apart = abs(self.bounce - other.bounce) > SAME_BOUNCE * max(self.bounce, other.bounce)
        return same and not (apart and np.any(one))


def rattles(compiled: CompiledRobot, segment: Segment, response: TorqueResponse, play: Play) -> Array:
    """Return how links scatter while they cross the gaps of their gears and bounce, shape (T, n), in gaps.

    A link that moves crosses when the torque on its gear changes sign, and bounces too when that becomes so small that
    what the arm rings is enough. One that stands crosses when a load that friction does not hold pushes it over.

    Args:
        compiled: The robot.
        segment: A motion.
        response: Of its readings to torques.
        play: Of the gears.
    """
    torque, time = response.transmitted, segment.motion.time[segment.motion.read][:, None]
    light = LIGHT * compiled.stiffness * play.gaps
    moves = (play.gaps > 0) & np.logical_not(segment.standing)
    is_light: NDArray[np.bool_] = np.abs(torque) < light
    held = np.abs(response.link_load) <= compiled.link_coulomb
    last = np.maximum.accumulate(np.where(held, 0, np.arange(len(torque))[:, None]), axis=0)
    pushed = np.take_along_axis(np.sign(response.link_load) * ~held, last, axis=0)
    side = np.where(segment.standing, pushed, np.sign(torque))
    changed: NDArray[np.bool_] = np.diff(side, axis=0, prepend=side[:1]) != 0
    crosses = changed & (play.gaps > 0)
    begins = crosses | (is_light & np.concatenate([np.ones_like(moves)[None], ~is_light[:-1]]) & moves)
    since = time - np.maximum.accumulate(np.where(begins, time, -np.inf))
    period = 2 * np.pi * np.sqrt(response.link_inertia / compiled.stiffness)
    height = light / np.maximum(np.abs(torque), np.maximum(light, TINY))
    scatter = np.asarray(play.bounce * height * np.exp(-2 * np.pi * DAMPING_RATIO * since / period), dtype=np.float64)
    change = np.abs(np.diff(torque, axis=0))
    for rows in (slice(1, None), slice(None, -1)):  # after and before the crossing
        soon = np.logical_or(segment.standing, np.abs(torque[rows]) <= NEAR * change)
        is_near = np.logical_and(crosses[1:], soon)
        scatter[rows] = np.where(is_near, np.maximum(scatter[rows], PLACED), scatter[rows])
    return scatter
