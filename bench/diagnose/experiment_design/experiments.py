"""Experiments that a lab could make next with any robot: another run, or today's runs with another instrument.

Poses are those of the campaign, for nobody knows here what stands around the robot. A run is sketched with a few
instants, each as precise as one reading of today; a real one has more, so what is expected of it is rather too little.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.experiment_design.workspace import LEAST_SWEEP, Workspace
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.segments import Segment
from bench.effects.conditions import Conditions
from bench.record.campaign import Array
from bench.simulate.prescribed import Motion

INSTANTS = 6  # effort: of one way of a sweep
SLOW, FAST = 0.05, 0.5  # declared: of a joint's speed limit
APPROACH = 0.1  # declared: of a sweep, before its first instant that is read
LOADS = (1 / 3, 2 / 3, 1.0)  # declared: of the rated force
POSES = 3  # effort: at which a force is put on
WARM_K = 25.0  # declared: [K], by which gears and motors are warmer after an hour of motion, as the proposal says
# declared: [s] of rest, at which everything is read: gas and gears settle over decades
DWELL_S = (1.0, 60.0, 300.0, 1800.0, 7200.0)
REPEATED = 10  # effort: segments of today that stand for all
REPEATED_INSTANTS = 4  # effort: of each of them that are read


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


def experiments_for(linear: LinearisedModel, is_thermal: bool) -> tuple[Experiment, ...]:
    """Return everything that is tried.

    Args:
        linear: Today's campaign.
        is_thermal: Whether an explanation depends on temperatures, so that a warm robot is worth trying.
    """
    workspace = Workspace(linear)
    found = [*_instruments(workspace), *_sweeps(workspace), *_loadings(workspace), *_dwell(workspace)]
    return tuple([*found, *_warm_sweeps(workspace)] if is_thermal else found)


def _instruments(workspace: Workspace) -> Iterator[Experiment]:
    """Yield today's runs once more, with what was not there."""
    every = workspace.linear.segments
    chosen = [every[i] for i in np.unique(np.linspace(0, len(every) - 1, REPEATED).round().astype(int))]
    for joint in range(workspace.n):  # a link encoder says little of a joint that no chosen segment moves or loads
        moving = [s for s in workspace.motions if not s.standing[joint] and all(s is not other for other in chosen)]
        chosen += moving[:1]
    thinned = [_thinned(s.motion, workspace.later) for s in chosen]
    groups: dict[tuple[str, int], list[int]] = {}
    for c in np.flatnonzero(~workspace.today):
        quantity = workspace.quantities[c]
        groups.setdefault((quantity.kind, quantity.index), []).append(int(c))
    for (kind, index), members in groups.items():
        columns = np.isin(np.arange(len(workspace.quantities)), members)
        segments = tuple(
            workspace.segment(motion, s.run, s.is_static, s.conditions, columns)
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


def _sweeps(workspace: Workspace) -> Iterator[Experiment]:
    for joint in range(workspace.n):
        for payload in (0.0, workspace.payload):
            for share in (SLOW, FAST):
                load = f"with {payload:g} kg at the load point" if payload else "without payload"
                yield _sweep(workspace, joint, share, Conditions.reference(workspace.n, payload), load)


def _warm_sweeps(workspace: Workspace) -> Iterator[Experiment]:
    cold = Conditions.reference(workspace.n)
    warm = replace(cold, gear_k=cold.gear_k + WARM_K, winding_k=cold.winding_k + WARM_K)
    for joint in range(workspace.n):
        for share in (SLOW, FAST):
            words = f"after an hour of motion, gears and motors {WARM_K:.0f} K warmer and their thermometers on"
            yield _sweep(workspace, joint, share, warm, words)


def _sweep(workspace: Workspace, joint: int, share: float, conditions: Conditions, load: str) -> Experiment:
    speed = share * workspace.compiled.robot.figures.drives[joint].speed_limit_rad_per_s
    low, high = workspace.span_of(joint)
    unit = "m/s" if workspace.compiled.is_slide[joint] else "deg/s"
    shown = speed if workspace.compiled.is_slide[joint] else np.rad2deg(speed)
    words = (
        f"sweep of joint {joint + 1} from {workspace.place(joint, low)} to {workspace.place(joint, high)} and back "
        f"at {shown:.2g} {unit}, {load}"
    )
    segments = []
    for sign in (1.0, -1.0):
        path = np.linspace(low + APPROACH * (high - low), high - APPROACH * (high - low), INSTANTS)[:: int(sign)]
        path = np.concatenate([[low if sign > 0 else high], path])
        q = np.tile(workspace.pose_for(joint), (len(path), 1))
        q[:, joint] = path
        velocity = np.zeros_like(q)
        velocity[:, joint] = sign * speed
        motion = Motion(
            time=workspace.later + np.abs(path - path[0]) / speed,
            q=q,
            velocity=velocity,
            acceleration=np.zeros_like(q),
            wrench=np.zeros((len(q), 6)),
            read=_after_first(len(q)),
        )
        segments.append(workspace.segment(motion, words, False, conditions, workspace.today))
    return Experiment(words, f"sweep {joint}", tuple(segments))


def _loadings(workspace: Workspace) -> Iterator[Experiment]:
    """Yield forces along x, y and down at poses of the campaign."""
    seen = workspace.statics or workspace.motions
    every = np.unique(np.round([s.motion.q[s.motion.read].mean(axis=0) for s in seen], 3), axis=0)
    rated = workspace.compiled.robot.figures.rating.force_n
    for pose in every[np.unique(np.linspace(0, len(every) - 1, POSES).round().astype(int))]:
        where = ", ".join(workspace.place(j, float(x)) for j, x in enumerate(pose))
        for axis, sign, name in ((0, 1.0, "along x"), (1, 1.0, "along y"), (2, -1.0, "downwards")):
            wrench = np.zeros((len(LOADS) + 2, 6))
            wrench[2:, axis] = sign * rated * np.array(LOADS)
            words = f"force of up to {rated:.0f} N {name} on the load point, at ({where})"
            times = workspace.later + 60.0 * np.arange(len(wrench), dtype=np.float64)
            motion = _resting(workspace, pose, times, wrench)
            segment = workspace.segment(motion, words, True, Conditions.reference(workspace.n), workspace.today)
            yield Experiment(words, f"loading {name}", (segment,))


def _dwell(workspace: Workspace) -> Iterator[Experiment]:
    """Yield a quick move of the joint that the campaign moved furthest, and then hours of rest."""
    joint = int(np.argmax(np.ptp(workspace.covered, axis=1)))
    low, high = workspace.span_of(joint)
    times = workspace.later + np.array([0.0, *DWELL_S])
    pose = workspace.pose_for(joint)
    pose[joint] = high
    motion = _resting(workspace, pose, times, np.zeros((len(times), 6)))
    motion.q[0, joint] = low
    words = (
        f"joint {joint + 1} quickly from {workspace.place(joint, low)} to {workspace.place(joint, high)}, "
        f"then {DWELL_S[-1] / 3600:.0f} h of rest in which everything is read"
    )
    segment = workspace.segment(motion, words, True, Conditions.reference(workspace.n), workspace.today)
    yield Experiment(words, "dwell", (segment,))


def _resting(workspace: Workspace, pose: Array, times: Array, wrench: Array) -> Motion:
    """Return rests at one pose, reached from a little below; the first instant is not read."""
    q = np.tile(pose, (len(times), 1))
    q[0] -= APPROACH * LEAST_SWEEP * np.ptp(workspace.limits, axis=1)
    zeros = np.zeros_like(q)
    return Motion(times, q, zeros, zeros, wrench, _after_first(len(times)))


def _after_first(count: int) -> NDArray[np.bool_]:
    """Return which instants are read: all but the first."""
    return np.asarray(np.arange(count) > 0)
