"""Experiments that a lab could make next with any robot: another run, or today's runs with another instrument.

Poses are those of the campaign, for nobody knows here what stands around the robot. A run is sketched with a few
instants, each as precise as one reading of today; a real one has more, so what is expected of it is rather too little.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.picture.design import Design
from bench.diagnose.replay.noise import UNIFORM
from bench.diagnose.replay.quantities import AXES, Quantity
from bench.diagnose.replay.segments import Segment
from bench.effects.effect import Conditions
from bench.record.campaign import Array
from bench.robot.compiled import CompiledRobot
from bench.simulate.prescribed import Motion

GRAVITY = 9.81  # [m/s^2]
INSTANTS = 6  # of one way of a sweep
SLOW, FAST = 0.05, 0.5  # of a joint's speed limit
LEAST_SWEEP = 0.1  # of a joint's range, to either side, where the campaign moved it less
MARGIN = 0.02  # of a joint's range, kept free at its ends
UNLIMITED = np.pi / 2  # [rad], taken for the range of a joint that has none
APPROACH = 0.1  # of a sweep, before its first instant that is read
LOADS = (1 / 3, 2 / 3, 1.0)  # of the rated force
POSES = 3  # at which a force is put on
WARM_K = 25.0  # [K], by which gears and motors are warmer after an hour of motion; assumed
DWELL_S = (1.0, 60.0, 300.0, 1800.0, 7200.0)
LATER_S = 600.0  # after the end of the campaign
REPEATED = 10  # segments of today that stand for all
REPEATED_INSTANTS = 4
LINK_ENCODER_SIGMA = 5e-6  # [rad] or [m]; ring encoders of robots, assumed
TRACKER_SIGMA = 30e-6  # [m], where the figures name no tracker


@dataclass(frozen=True, eq=False)
class Experiment:
    """One experiment; c quantities, those of today and those of instruments that could be added.

    Attributes:
        words: What to do.
        family: What it is like; of one family only the best is proposed.
        segments: What the robot does; `observed` is 0 where something is read, nan elsewhere.
    """

    words: str
    family: str
    segments: tuple[Segment, ...]


def quantities_with_more(design: Design) -> tuple[Quantity, ...]:
    """Return what could be compared: what is today, then link encoders, reflectors and gauge that are missing."""
    compiled = design.replay.compiled
    instruments = compiled.robot.figures.instruments
    there = {(q.kind, q.index, q.axis) for q in design.quantities}
    more = []
    for j, is_slide in enumerate(compiled.is_slide):
        unit = "m" if is_slide else "rad"
        more.append(Quantity(f"q_link_{j + 1}_{unit}", "q_link", unit, j))
    for k in range(len(compiled.robot.figures.reflectors)):
        more += [Quantity(f"reflector_{k + 1}_{a}_m", "reflector", "m", k, i) for i, a in enumerate(AXES)]
    if compiled.counterbalance is not None and instruments.pressure is not None:
        more.append(Quantity("gas_pressure_pa", "gas_pressure", "Pa"))
    return design.quantities + tuple(q for q in more if (q.kind, q.index, q.axis) not in there)


def experiments_for(design: Design, is_thermal: bool) -> tuple[Experiment, ...]:
    """Return everything that is tried.

    Args:
        design: Today's campaign.
        is_thermal: Whether an explanation depends on temperatures, so that a warm robot is worth trying.
    """
    lab = _Lab(design)
    found = [*_instruments(lab), *_sweeps(lab), *_loadings(lab), *_dwell(lab)]
    return tuple([*found, *_warm_sweeps(lab)] if is_thermal else found)


class _Lab:
    """What today's campaign says of the robot's cell.

    Args:
        design: Today's campaign.
    """

    def __init__(self, design: Design) -> None:
        self.design = design
        self.compiled: CompiledRobot = design.replay.compiled
        self.n = self.compiled.n_joints
        self.quantities = quantities_with_more(design)
        self.today = np.arange(len(self.quantities)) < len(design.quantities)
        segments = design.segments
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
            self.payload = round(self.compiled.robot.figures.rating.force_n / GRAVITY / 2)
        self.sigma = {is_static: self._sigma(is_static) for is_static in (True, False)}

    def _sigma(self, is_static: bool) -> Array:
        """Return the noise of one reading of every quantity, shape (c,)."""
        instruments = self.compiled.robot.figures.instruments
        alike = (self.statics if is_static else self.motions) or list(self.design.segments)
        found = []
        for c, quantity in enumerate(self.quantities):
            if self.today[c]:
                seen = np.concatenate([s.sigma[:, c][np.isfinite(s.observed[:, c])] for s in alike])
                if not len(seen):
                    every = np.concatenate([s.sigma[:, c] for s in self.design.segments])
                    seen = every[np.isfinite(every)]
                found.append(float(np.median(seen)))
            elif quantity.kind == "q_link":
                found.append(LINK_ENCODER_SIGMA)
            elif quantity.kind == "reflector":
                tracker = instruments.tracker
                far = float(np.linalg.norm(tracker.position_m)) if tracker else 0.0
                found.append(tracker.sigma_per_distance * far if tracker and far else TRACKER_SIGMA)
            else:
                assert instruments.pressure
                found.append(UNIFORM * instruments.pressure.resolution_pa)
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
        usual: Array = np.median(np.concatenate([s.motion.q[s.motion.read] for s in self.design.segments]), axis=0)
        return usual

    def segment(
        self, motion: Motion, words: str, is_static: bool, conditions: Conditions, columns: NDArray[np.bool_]
    ) -> Segment:
        """Return a segment in which some columns are read, shape (c,)."""
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
        )

    def place(self, joint: int, position: float) -> str:
        """Return a position of a joint in words."""
        return f"{position:.2f} m" if self.compiled.is_slide[joint] else f"{np.rad2deg(position):.0f} deg"


def _instruments(lab: _Lab) -> Iterator[Experiment]:
    """Yield today's runs once more, with what was not there."""
    every = lab.design.segments
    chosen = [every[i] for i in np.unique(np.linspace(0, len(every) - 1, REPEATED).round().astype(int))]
    for joint in range(lab.n):  # a link encoder says little of a joint that no chosen segment moves or loads
        moving = [s for s in lab.motions if not s.standing[joint] and all(s is not other for other in chosen)]
        chosen += moving[:1]
    thinned = [_thinned(s.motion, lab.later) for s in chosen]
    groups: dict[tuple[str, int], list[int]] = {}
    for c in np.flatnonzero(~lab.today):
        quantity = lab.quantities[c]
        groups.setdefault((quantity.kind, quantity.index), []).append(int(c))
    for (kind, index), members in groups.items():
        columns = np.isin(np.arange(len(lab.quantities)), members)
        segments = tuple(
            lab.segment(motion, s.run, s.is_static, s.conditions, columns)
            for s, motion in zip(chosen, thinned, strict=True)
        )
        name = {
            "q_link": f"a link encoder at joint {index + 1}",
            "reflector": f"the tracker on reflector {index + 1}",
            "gas_pressure": "a gauge of the gas pressure",
        }[kind]
        family = f"link encoder {index}" if kind == "q_link" else kind
        yield Experiment(f"the same runs with {name}", family, segments)


def _thinned(motion: Motion, later: float) -> Motion:
    read = np.flatnonzero(motion.read)
    kept = read[np.unique(np.linspace(0, len(read) - 1, REPEATED_INSTANTS).round().astype(int))]
    rows = np.sort(np.concatenate([np.flatnonzero(np.logical_not(motion.read)), kept]))
    return Motion(
        time=motion.time[rows] - motion.time[rows[0]] + later,
        q=motion.q[rows],
        velocity=motion.velocity[rows],
        acceleration=motion.acceleration[rows],
        wrench=motion.wrench[rows],
        read=motion.read[rows],
    )


def _sweeps(lab: _Lab) -> Iterator[Experiment]:
    for joint in range(lab.n):
        for payload in (0.0, lab.payload):
            for share in (SLOW, FAST):
                load = f"with {payload:g} kg at the load point" if payload else "without payload"
                yield _sweep(lab, joint, share, Conditions.reference(lab.n, payload), load)


def _warm_sweeps(lab: _Lab) -> Iterator[Experiment]:
    cold = Conditions.reference(lab.n)
    warm = replace(cold, gear_k=cold.gear_k + WARM_K, winding_k=cold.winding_k + WARM_K)
    for joint in range(lab.n):
        for share in (SLOW, FAST):
            words = f"after an hour of motion, gears and motors {WARM_K:.0f} K warmer and their thermometers on"
            yield _sweep(lab, joint, share, warm, words)


def _sweep(lab: _Lab, joint: int, share: float, conditions: Conditions, load: str) -> Experiment:
    speed = share * lab.compiled.robot.figures.drives[joint].speed_limit_rad_per_s
    low, high = lab.span_of(joint)
    unit = "m/s" if lab.compiled.is_slide[joint] else "deg/s"
    shown = speed if lab.compiled.is_slide[joint] else np.rad2deg(speed)
    words = (
        f"sweep of joint {joint + 1} from {lab.place(joint, low)} to {lab.place(joint, high)} and back "
        f"at {shown:.2g} {unit}, {load}"
    )
    segments = []
    for sign in (1.0, -1.0):
        path = np.linspace(low + APPROACH * (high - low), high - APPROACH * (high - low), INSTANTS)[:: int(sign)]
        path = np.concatenate([[low if sign > 0 else high], path])
        q = np.tile(lab.pose_for(joint), (len(path), 1))
        q[:, joint] = path
        velocity = np.zeros_like(q)
        velocity[:, joint] = sign * speed
        motion = Motion(
            time=lab.later + np.abs(path - path[0]) / speed,
            q=q,
            velocity=velocity,
            acceleration=np.zeros_like(q),
            wrench=np.zeros((len(q), 6)),
            read=_after_first(len(q)),
        )
        segments.append(lab.segment(motion, words, False, conditions, lab.today))
    return Experiment(words, f"sweep {joint}", tuple(segments))


def _loadings(lab: _Lab) -> Iterator[Experiment]:
    """Yield forces along x, y and down at poses of the campaign."""
    seen = lab.statics or lab.motions
    every = np.unique(np.round([s.motion.q[s.motion.read].mean(axis=0) for s in seen], 3), axis=0)
    rated = lab.compiled.robot.figures.rating.force_n
    for pose in every[np.unique(np.linspace(0, len(every) - 1, POSES).round().astype(int))]:
        where = ", ".join(lab.place(j, float(x)) for j, x in enumerate(pose))
        for axis, sign, name in ((0, 1.0, "along x"), (1, 1.0, "along y"), (2, -1.0, "downwards")):
            wrench = np.zeros((len(LOADS) + 2, 6))
            wrench[2:, axis] = sign * rated * np.array(LOADS)
            words = f"force of up to {rated:.0f} N {name} on the load point, at ({where})"
            times = lab.later + 60.0 * np.arange(len(wrench), dtype=np.float64)
            motion = _resting(lab, pose, times, wrench)
            segment = lab.segment(motion, words, True, Conditions.reference(lab.n), lab.today)
            yield Experiment(words, f"loading {name}", (segment,))


def _dwell(lab: _Lab) -> Iterator[Experiment]:
    """Yield a quick move of the joint that the campaign moved furthest, and then hours of rest."""
    joint = int(np.argmax(np.ptp(lab.covered, axis=1)))
    low, high = lab.span_of(joint)
    times = lab.later + np.array([0.0, *DWELL_S])
    pose = lab.pose_for(joint)
    pose[joint] = high
    motion = _resting(lab, pose, times, np.zeros((len(times), 6)))
    motion.q[0, joint] = low
    words = (
        f"joint {joint + 1} quickly from {lab.place(joint, low)} to {lab.place(joint, high)}, "
        f"then {DWELL_S[-1] / 3600:.0f} h of rest in which everything is read"
    )
    segment = lab.segment(motion, words, True, Conditions.reference(lab.n), lab.today)
    yield Experiment(words, "dwell", (segment,))


def _resting(lab: _Lab, pose: Array, times: Array, wrench: Array) -> Motion:
    """Return rests at one pose, reached from a little below; the first instant is not read."""
    q = np.tile(pose, (len(times), 1))
    q[0] -= APPROACH * LEAST_SWEEP * np.ptp(lab.limits, axis=1)
    zeros = np.zeros_like(q)
    return Motion(times, q, zeros, zeros, wrench, _after_first(len(times)))


def _after_first(count: int) -> Array:
    """Return which instants are read: all but the first."""
    return np.asarray(np.arange(count) > 0)
