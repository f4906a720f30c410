"""Motions, cut into bins that are short against everything that changes and long against everything that rings."""

from collections.abc import Iterator

import mujoco
import numpy as np
from scipy.ndimage import maximum_filter1d

from bench.diagnose.replay.segment_input import Path, SegmentInput, angles_of, centre_weights, wrench_of
from bench.diagnose.replay.static_segments import APPROACH
from bench.diagnose.replay.uneven_derivative import derivative_over
from bench.record.campaign import Array, Run
from bench.robot.compiled import CompiledRobot
from bench.simulate.prescribed import Motion

LONGEST_WINDOW = 0.06  # [s], over which motion is differentiated; less where bins are shorter
LEAST_WINDOW = 5  # samples
TURNING = 0.08  # of a joint's top speed in a run; below it, it starts, stops or turns round
UNRESOLVED = 0.5  # of the difference between accelerations over one window and over two, that may be error
RINGS = 0.2  # [s], for which a jerk is felt before and after
JERKY = 0.01  # of a joint's top speed, by which that changes unsteadily within a period of the arm's lowest mode
SETTLES = 5.0  # periods of that mode, after which an arm rings no more: a fifth is left with a damping ratio of 0.05
STANDS = 1e-4  # [rad/s] or [m/s]; below it a joint counts as standing
TRAVELS = 0.005  # [rad] or [m]; a joint that goes less far in a run only gives: its friction does not slide


def stretches_of(run: Run, compiled: CompiledRobot, width: float) -> Iterator[SegmentInput]:
    """Yield the motion of a run as one piece, cut into bins.

    The links follow quasi-statically in a replay, so bins are no narrower than half a period of the arm's lowest
    mode: what rings averages out of torque and acceleration alike.

    Args:
        run: A motion.
        compiled: Its robot.
        width: [s], of the bins at least.
    """
    if len(run) < LEAST_WINDOW:
        return
    time = run.columns["time_s"]
    dt = float(np.median(np.diff(time)))
    angles, wrenches = angles_of(run, compiled), wrench_of(run, compiled)
    period = lowest_period(compiled, angles.mean(axis=0))
    width = max(width, period / 2)
    samples = max(1, round(width / dt))
    window = 2 * round(min(LONGEST_WINDOW, samples * dt) / dt / 2) + 1
    window = int(np.clip(window, LEAST_WINDOW, 2 * ((len(run) - 1) // 2) - 1))
    velocity, acceleration = (derivative_over(angles, time, window, order) for order in (1, 2))
    error = _acceleration_error(angles, acceleration, window, time)
    edges = np.arange(0, len(run), samples)
    if len(edges) > 1 and len(run) - edges[-1] < samples:
        edges = edges[:-1]
    groups = np.split(np.arange(len(run)), edges[1:])
    top = np.max(np.abs(velocity), axis=0)
    moves = (top > STANDS) & (np.ptp(angles, axis=0) > TRAVELS)
    slowest = np.stack([np.min(np.abs(velocity[group]), axis=0) for group in groups])
    turning = moves & (slowest < TURNING * top)
    useful = np.any(moves & ~turning, axis=1) | ~np.any(moves)  # some joint slides on
    if not np.any(useful):
        return
    kept = tuple(group for group, is_useful in zip(groups, useful, strict=True) if is_useful)

    def mean(values: Array) -> Array:
        centred: Array = np.stack([centre_weights(len(group)) @ values[group] for group in kept])
        return centred

    q, v, a = mean(angles), mean(velocity), mean(acceleration)
    still = ~moves
    v[:, still] = a[:, still] = 0.0
    q[:, still] = q[:, still].mean(axis=0)
    first = v[0]
    motion = Motion(
        time=run.start_s + np.concatenate([[time[kept[0][0]] - 1.0], mean(time)]),
        q=np.concatenate([q[:1] - np.sign(first) * APPROACH, q]),
        velocity=np.concatenate([v[:1], v]),
        acceleration=np.concatenate([np.zeros_like(a[:1]), a]),
        wrench=np.concatenate([mean(wrenches)[:1], mean(wrenches)]),
        read=np.concatenate([[False], np.ones(len(kept), dtype=bool)]),
    )
    worst = np.stack([error[group].max(axis=0) for group in kept])
    worst[:, still] = 0.0
    jerky = np.any(error[:, moves] * period > JERKY * top[moves], axis=1)
    after = time - np.maximum.accumulate(np.where(jerky, time, time[0]))  # a run may begin right after a ramp
    rings = np.array([np.any(after[group] < SETTLES * period) for group in kept])
    yield SegmentInput(run.name, kept, motion, worst, turning[useful], rings, Path(time, angles, kept))


def lowest_period(compiled: CompiledRobot, q: Array) -> float:
    """Return the period of the arm's lowest mode with its motors held at angles q, shape (n,) [s]."""
    model, at = compiled.model, compiled.at
    data = mujoco.MjData(model)
    data.qpos[at.theta] = data.qpos[at.q] = q
    mujoco.mj_fwdPosition(model, data)
    full = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, full)
    inertia = full[np.ix_(at.theta_dof, at.theta_dof)]
    # M x'' = -K x; the largest eigenvalue of K^-1/2 M K^-1/2 is 1 / omega^2
    root = 1 / np.sqrt(compiled.stiffness)
    return float(2 * np.pi * np.sqrt(np.linalg.eigvalsh(root[:, None] * inertia * root)[-1]))


def _acceleration_error(angles: Array, acceleration: Array, window: int, time: Array) -> Array:
    """Return how far an acceleration may be off where it changes fast, shape (rows, n): what half the resolution adds.

    Where motion jerks, links ring for a while after it; the error is therefore kept up over a few windows.
    """
    longer = min(2 * window + 1, 2 * ((len(angles) - 1) // 2) - 1)
    if longer <= window:
        return np.zeros_like(angles)
    coarse = derivative_over(angles, time, longer, 2)
    reach = max(longer, 2 * round(RINGS / float(np.median(np.diff(time))) / 2) + 1)
    error: Array = UNRESOLVED * maximum_filter1d(np.abs(acceleration - coarse), reach, axis=0)
    return error
