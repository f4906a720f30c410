"""What a campaign says of a robot's cell: where the robot moved, what is read and how well, what it may carry."""

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.experiment_design.new_instruments import noise_of_new
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.quantities import AXES, Quantity
from bench.diagnose.replay.segments import Segment
from bench.effects.conditions import Conditions
from bench.record.campaign import Array
from bench.record.units import STANDARD_GRAVITY
from bench.robot.compiled import CompiledRobot
from bench.simulate.prescribed import Motion

LEAST_SWEEP = 0.1  # declared: of a joint's range, to either side, where the campaign moved it less
MARGIN = 0.02  # declared: of a joint's range, kept free at its ends
UNLIMITED = np.pi / 2  # declared: [rad], to either side, taken for the range of a joint that has none
LATER_S = 600.0  # declared: [s], after the end of the campaign


def quantities_with_more(linear: LinearisedModel) -> tuple[Quantity, ...]:
    """Return what could be compared: what is today, then link encoders, reflectors and gauge that are missing."""
    compiled = linear.replay.compiled
    instruments = compiled.robot.figures.instruments
    there = {(q.kind, q.index, q.axis) for q in _today(linear)}
    more = []
    for j, is_slide in enumerate(compiled.is_slide):
        unit = "m" if is_slide else "rad"
        more.append(Quantity(f"q_link_{j + 1}_{unit}", "q_link", unit, j))
    for k in range(len(compiled.robot.figures.reflectors)):
        more += [Quantity(f"reflector_{k + 1}_{a}_m", "reflector", "m", k, i) for i, a in enumerate(AXES)]
    if compiled.counterbalance is not None and instruments.pressure is not None:
        more.append(Quantity("gas_pressure_pa", "gas_pressure", "Pa"))
    return _today(linear) + tuple(q for q in more if (q.kind, q.index, q.axis) not in there)


def _today(linear: LinearisedModel) -> tuple[Quantity, ...]:
    """Return what instruments read, which comes before what the lab knows besides."""
    return tuple(quantity for quantity in linear.quantities if not quantity.is_known)


class Workspace:
    """What today's campaign says of the robot's cell.

    Args:
        linear: Today's campaign.
    """

    def __init__(self, linear: LinearisedModel) -> None:
        self.linear = linear
        self.compiled: CompiledRobot = linear.replay.compiled
        self.n = self.compiled.n_joints
        self.quantities = quantities_with_more(linear)
        self.today = np.arange(len(self.quantities)) < len(_today(linear))
        segments = linear.segments
        self.statics = [s for s in segments if s.is_static]
        self.motions = [s for s in segments if not s.is_static]
        self.later = max(float(s.motion.time[-1]) for s in segments) + LATER_S
        angles = np.concatenate([s.motion.q[s.motion.read] for s in segments])
        self.covered = np.stack([angles.min(axis=0), angles.max(axis=0)], axis=1)
        limits = self.compiled.limits
        unlimited = limits[:, 1] <= limits[:, 0]
        self.limits = np.where(unlimited[:, None], np.array([-UNLIMITED, UNLIMITED]), limits)
        self.payload = max(s.conditions.payload_kg for s in segments)
        if self.payload == 0:
            self.payload = round(self.compiled.robot.figures.rating.force_n / STANDARD_GRAVITY / 2)
        self.sigma = {is_static: self._sigma(is_static) for is_static in (True, False)}

    def _sigma(self, is_static: bool) -> Array:
        """Return the noise of one reading of every quantity, shape (c,)."""
        alike = (self.statics if is_static else self.motions) or list(self.linear.segments)
        found = []
        for c, quantity in enumerate(self.quantities):
            if self.today[c]:
                seen = np.concatenate([s.sigma[:, c][np.isfinite(s.observed[:, c])] for s in alike])
                if not len(seen):
                    every = np.concatenate([s.sigma[:, c] for s in self.linear.segments])
                    seen = every[np.isfinite(every)]
                found.append(float(np.median(seen)))
            else:
                found.append(noise_of_new(quantity, self.compiled))
        return np.array(found)

    def span_of(self, joint: int) -> tuple[float, float]:
        """Return between which positions a joint is swept: where the campaign moved it, and a little at least."""
        low, high = self.limits[joint]
        wide = float(high - low)
        middle = float(self.covered[joint].mean())
        half = max(float(np.ptp(self.covered[joint])) / 2, LEAST_SWEEP * wide)
        return max(middle - half, float(low) + MARGIN * wide), min(middle + half, float(high) - MARGIN * wide)

    def pose_for(self, joint: int) -> Array:
        """Return the pose, shape (n,), in which the campaign moved a joint most, or its usual pose."""
        moving = [s for s in self.motions if not s.standing[joint]]
        if moving:
            longest = max(moving, key=lambda s: float(np.ptp(s.motion.q[:, joint])))
            pose: Array = longest.motion.q.mean(axis=0)
            return pose
        usual: Array = np.median(np.concatenate([s.motion.q[s.motion.read] for s in self.linear.segments]), axis=0)
        return usual

    def segment(
        self, motion: Motion, words: str, is_static: bool, conditions: Conditions, columns: NDArray[np.bool_]
    ) -> Segment:
        """Return a segment in which some columns are read, shape (c,), as if it were made in the last recording."""
        length = int(motion.read.sum())
        shape = (length, len(self.quantities))
        return Segment(
            run=words,
            label=words,
            is_static=is_static,
            motion=motion,
            conditions=conditions,
            observed=np.where(columns, np.zeros(shape), np.nan),
            sigma=np.where(columns, np.broadcast_to(self.sigma[is_static], shape), np.nan),
            standing=np.all(motion.velocity == 0, axis=0),
            acceleration_error=np.zeros((length, self.n)),
            rings=np.zeros(length, dtype=bool),
            recording=self.linear.segments[-1].recording,
        )

    def place(self, joint: int, position: float) -> str:
        """Return a position of a joint in words."""
        return f"{position:.2f} m" if self.compiled.is_slide[joint] else f"{np.rad2deg(position):.0f} deg"
