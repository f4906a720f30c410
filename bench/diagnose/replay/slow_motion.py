"""How much of a drive's motion is compared: where it goes slowly or turns round, friction is not at its level."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment


@dataclass(frozen=True)
class SlowMotion:
    """What of a drive's motion is compared.

    Attributes:
        channel: Column of its current or torque.
        share: Of the time of the runs in which its joint moves, that is compared.
        slowest: Least speed that is compared [rad/s] or [m/s]; nan where nothing is.
        unit: Of that.
    """

    channel: str
    share: float
    slowest: float
    unit: str


def slow_motion(
    segments: Iterable[Segment], quantities: Sequence[Quantity], slides: Sequence[bool]
) -> tuple[SlowMotion, ...]:
    """Return how much of the motion of each drive is compared, drive by drive; of none that never moves.

    Args:
        segments: Of the campaign.
        quantities: Of its readings.
        slides: Of each joint, whether it slides.
    """
    moving = [(one, one.path) for one in segments if one.path is not None]
    found = []
    for c, quantity in enumerate(quantities):
        if not quantity.is_drive:
            continue
        j, samples, compared, speeds = quantity.index, 0, 0, [np.zeros(0)]
        for segment, path in moving:
            if segment.standing[j]:
                continue
            seen = np.isfinite(segment.observed[:, c])
            samples += len(path.time)
            compared += sum(len(group) for group, is_seen in zip(path.groups, seen, strict=True) if is_seen)
            speeds.append(np.abs(segment.motion.velocity[segment.motion.read, j])[seen])
        if samples:
            slowest = float(np.min(np.concatenate(speeds), initial=np.inf)) if compared else np.nan
            found.append(SlowMotion(quantity.column, compared / samples, slowest, "m/s" if slides[j] else "rad/s"))
    return tuple(found)
