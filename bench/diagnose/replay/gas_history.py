"""How warm the gas of the counterbalance is where motions begin, whichever models follow which of them.

Gas that was compressed stays warm for a minute or two, over the end of a run and into the next. Models follow the runs
of a payload, or of a temperature, each by itself; what came before is told here, once for all of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.instants import slices_of
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array
from bench.robot.counterbalance import Counterbalance


@dataclass(frozen=True, eq=False)
class GasHistory:
    """Where the joints were during a campaign; T instants, n drives.

    Attributes:
        theta: Shape (T, n), angles of the links by the nominal robot; in no world do they differ by what counts here.
        time: Shape (T,) [s], as of the motions, but that none begins before the last has ended.
        recordings: Of each, its instants in the order of the clock, and the times between them [s]. The first of each
            motion is there twice: when the robot comes, and when the motion begins.
    """

    theta: Array
    time: Array
    recordings: tuple[tuple[NDArray[np.intp], Array], ...]

    @classmethod
    def of(cls, segments: Sequence[Segment], theta: Array) -> Self:
        """Return the history of a campaign.

        Nobody recorded when the robot went from the end of a motion to where the next one begins: it is taken to go at
        once and to wait there. Where the next one is assumed to begin before the last had ended, no time passes.

        Args:
            segments: Of the campaign.
            theta: Shape (T, n), of all their instants.
        """
        places = slices_of(len(segment.motion) for segment in segments)
        members: dict[str, list[int]] = {}
        for i, segment in enumerate(segments):
            members.setdefault(segment.recording, []).append(i)
        time = np.concatenate([segment.motion.time for segment in segments])
        recordings = []

        def last_of(i: int) -> float:
            return float(segments[i].motion.time[-1])

        for some in members.values():
            ordered = [np.arange(places[i].start, places[i].stop) for i in sorted(some, key=last_of)]
            end, passed = time[ordered[0][0]], []
            for mine in ordered:
                time[mine] = np.maximum(time[mine], end)
                passed += [0.0, time[mine[0]] - end, *np.diff(time[mine])]
                end = time[mine[-1]]
            recordings.append((np.concatenate([[mine[0], *mine] for mine in ordered]), np.array(passed[1:])))
        return cls(theta, time, tuple(recordings))

    def rise(self, cylinder: Counterbalance) -> Array:
        """Return T / T0 - 1 of the gas at each instant, shape (T,).

        Args:
            cylinder: With gas that warms up.
        """
        found = np.empty(len(self.theta))
        for instants, passed in self.recordings:
            found[instants] = cylinder.temperature_rise(self.theta[instants, cylinder.joint], passed)
        return found
