"""What averaged torques of a world's robot have more than those of the averaged motion: its links', and its friction's.

Most worlds of a fit have links that another one had; what is made of them is kept.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np

from bench.diagnose.replay.average_friction import average_friction, bends
from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.robot.links import Poses, inertial_parameters, poses_of
from bench.robot.recent import Recent

MOST_LINKS = 64  # effort: sets of inertial parameters kept


class AveragedMore:
    """What averaged torques have more, of one robot after another; several threads may ask at once."""

    def __init__(self) -> None:
        self._inertial: Recent[bytes, Array] = Recent(MOST_LINKS)  # parameters of links, by what models have
        self._poses: Recent[bytes, Poses] = Recent(MOST_LINKS)  # likewise

    def of(self, compiled: CompiledRobot, segments: Sequence[Segment], rows: Sequence[slice]) -> Array:
        """Return what averaged torques of segments have more, each in its rows, shape (K, n) [Nm] or [N].

        Args:
            compiled: The robot.
            segments: With what averages are made of.
            rows: Of each segment.
        """
        found = np.zeros((rows[-1].stop, compiled.n_joints))
        if not any(segment.average_excess for segment in segments):
            return found
        links, bent = self._inertial_parameters(compiled), bends(compiled)
        for segment, mine in zip(segments, rows, strict=True):
            if segment.average_excess and segment.path:
                found[mine] = segment.average_excess.torque(links)
                if np.any(bent):
                    speed = segment.motion.velocity[segment.motion.read]
                    found[mine] += average_friction(compiled, segment.path, speed)
        return found

    def _inertial_parameters(self, compiled: CompiledRobot) -> Array:
        """Return the inertial parameters of the links of a robot, with what is bolted on, shape (10 n,)."""
        model = compiled.model
        placed = b"".join(part.tobytes() for part in (model.body_pos, model.body_quat, model.jnt_pos))
        weighed = (model.body_mass, model.body_inertia, model.body_ipos, model.body_iquat)
        key = placed + b"".join(part.tobytes() for part in weighed)
        poses = partial(self._poses.get, placed, lambda: poses_of(compiled))
        return self._inertial.get(key, lambda: inertial_parameters(compiled, poses()))
