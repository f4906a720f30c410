"""Channels with another clock: what they would have shown had they been read when the encoders were.

Where the reflectors were a moment ago follows from where the motors were then. What the links gave and the pull of the
cylinder change slowly; they are interpolated between the instants that are read. Torques of drives jump with the
acceleration: these are simulated along the earlier motion (`Replay`).
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from bench.diagnose.replay.courses import count_of
from bench.diagnose.replay.instants import slices_of
from bench.diagnose.replay.jacobians import reflector_places
from bench.diagnose.replay.segments import Segment
from bench.effects.recorded import Lateness
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.simulate.trace import Trace


def read_late(compiled: CompiledRobot, segments: Sequence[Segment], trace: Trace, late: Sequence[Lateness]) -> Trace:
    """Return the truth with the quantities in it that are late replaced by what they were before.

    Args:
        compiled: The nominal robot.
        segments: Of a campaign; at rest nothing changes.
        trace: At all instants that are read, segment after segment.
        late: Reflectors, and the force of the gas, that are late.
    """
    for one in late:
        values = getattr(trace, one.field).copy()
        for segment, rows in zip(segments, slices_of(count_of(segment) for segment in segments), strict=True):
            if segment.is_static:
                continue
            there = trace[rows]
            if one.field == "reflectors":
                gives = there.theta - there.q
                given = np.stack([_before(there.time, column, one.seconds) for column in gives.T], axis=1)
                before = there.q + earlier(segment, one.seconds) + given
                moved = reflector_places(compiled, before) - reflector_places(compiled, there.theta)
                values[rows] = there.reflectors + moved
            else:
                values[rows] = _before(there.time, values[rows], one.seconds)
        trace = replace(trace, **{one.field: values})
    return trace


def earlier(segment: Segment, seconds: float) -> Array:
    """Return how much further the motors were some time before the instants that are read, shape (T, n) [rad].

    Of a motion that nobody measured only velocity and acceleration are known.
    """
    if segment.path is not None:
        return segment.path.earlier(seconds)
    motion = segment.motion
    moved: Array = (-seconds * motion.velocity + seconds**2 / 2 * motion.acceleration)[motion.read]
    return moved


def _before(time: Array, values: Array, seconds: float) -> Array:
    """Return values over time, shape (T,), as they were some time before."""
    if len(time) == 1:
        return values
    when = np.clip(time - seconds, time[0], time[-1])
    found: Array = CubicHermiteSpline(time, values, np.gradient(values, time))(when)
    return found
