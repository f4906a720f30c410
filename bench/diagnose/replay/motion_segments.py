"""Motions, cut into bins that are short against everything that changes and long against everything that rings."""

import math
from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from bench.diagnose.replay.average_excess import average_excess
from bench.diagnose.replay.resolution import LEAST_WINDOW, angle_noise, finest_window, missed_by_average
from bench.diagnose.replay.segment_input import Path, SegmentInput, angles_of, centre_weights, wrench_of
from bench.diagnose.replay.smooth_derivative import averaging_kernel
from bench.diagnose.replay.static_segments import APPROACH
from bench.diagnose.replay.uneven_derivative import derivative_over, is_even
from bench.identify.arm import Arm
from bench.record.campaign import Array, Run
from bench.record.moving import TRAVELS, TURNING
from bench.robot.compiled import CompiledRobot
from bench.robot.links import rigid_bodies
from bench.robot.mass_matrix import link_mass_matrix
from bench.simulate.prescribed import Motion

# assumed: [s], over which motion is differentiated at least, where an arm is so stiff that its lowest mode is faster
STIFF_WINDOW = 0.06
LEAST_BINS = 30  # declared: of a run; with fewer no figure is told from another, however exactly each is read
UNRESOLVED = 0.5  # assumed: of the difference between accelerations over one window and over two, that may be error
# assumed: of a joint's top speed, by which that changes unsteadily within a period of the arm's lowest mode
JERKY = 0.01
# exact: times a sudden change of speed over a window: by as much differ accelerations over one window and over two, for
# the average over one has its peak at 15/8 of the change over the window, and that over two at half of it
PEAK = 15 / 16
# assumed: of modes with their motors held: bolted joints and gears of large arms, 0.01 to 0.05 in our models
DAMPING_RATIO = 0.05
FADED = 0.2  # assumed: of an oscillation's amplitude, which is left when an arm rings no more
STANDS = 1e-4  # rounding: [rad/s] or [m/s]; below it a joint counts as standing


def stretches_of(
    run: Run, compiled: CompiledRobot, width: float, torque_noise: Array | None = None
) -> Iterator[SegmentInput]:
    """Yield the motion of a run as one piece, cut into bins.

    Links follow quasi-statically in a replay, which is right for what their motors do slowly. What they do faster than
    the lowest mode, links do not follow, and what rings there nobody commanded. So torques and accelerations are
    averaged alike, over a period of that mode: half a period lets 0.83 of it through, one 0.46.

    Args:
        run: A motion.
        compiled: Its robot.
        width: [s], of the bins at least.
        torque_noise: Shape (n,), of a sample of what each drive reports [Nm] or [N], nan where it was not read; bins
            are so wide that angles add no more to it. None: nothing was read.
    """
    if len(run) < LEAST_WINDOW:
        return
    time = run.columns["time_s"]
    dt = float(np.median(np.diff(time)))
    angles, wrenches = angles_of(run, compiled), wrench_of(run, compiled)
    period = lowest_period(compiled, angles.mean(axis=0))
    width = max(width, period)
    longest = max(STIFF_WINDOW, period)
    if torque_noise is not None:
        inertia = link_mass_matrix(compiled, angles.mean(axis=0)) + np.diag(
            compiled.model.dof_armature[compiled.at.q_dof]
        )
        stiffness = Arm(rigid_bodies(compiled)).gravity_stiffness(angles.mean(axis=0))
        least, most = min(longest, width, len(run) * dt), float(np.ptp(time)) / LEAST_BINS
        missed = partial(missed_by_average, angles, stiffness)
        finest = finest_window(angle_noise(angles), inertia, torque_noise, dt, least, most, missed)
        longest, width = max(longest, finest), max(width, finest)
    samples = max(1, round(width / dt))
    window = 2 * round(min(longest, samples * dt) / dt / 2) + 1
    window = int(np.clip(window, LEAST_WINDOW, 2 * ((len(run) - 1) // 2) - 1))
    velocity, acceleration = (derivative_over(angles, time, window, order) for order in (1, 2))
    unresolved = _unresolved(angles, acceleration, window, time)
    error = kept_up(unresolved, window, time, period)
    kernel = averaging_kernel(window) if is_even(time) else np.ones(1)
    kernel = kernel if len(kernel) <= samples else np.ones(1)  # no longer than a bin: else it would blur what is fine
    edges = np.arange(0, len(run), samples)
    if len(edges) > 1 and len(run) - edges[-1] < samples:
        edges = edges[:-1]
    groups = np.split(np.arange(len(run)), edges[1:])
    top = np.max(np.abs(velocity), axis=0)
    moves = (top > STANDS) & (np.ptp(angles, axis=0) > TRAVELS)
    slowest = np.stack([np.min(np.abs(velocity[group]), axis=0) for group in groups])
    useful = np.any(moves & (slowest >= TURNING * top), axis=1) | ~np.any(moves)  # some joint slides on
    if not np.any(useful):
        return
    kept = tuple(group for group, is_useful in zip(groups, useful, strict=True) if is_useful)
    shapes = maximum_filter1d(useful.astype(np.int8), 3) > 0  # the bins beside them tell where friction turned round
    followed = tuple(group for group, shapes_friction in zip(groups, shapes, strict=True) if shapes_friction)
    path = Path(time, angles, kept, kernel, round(longest / dt), window)
    near = np.stack([np.min(np.abs(velocity[rows]), axis=0) for rows, _ in path.of_torque])  # torques feel a turn there
    turning = moves & (np.minimum(slowest[useful], near) < TURNING * top)

    def mean(values: Array, groups: Sequence[NDArray[np.int64]] = followed) -> Array:
        centred: Array = np.stack([centre_weights(len(group)) @ values[group] for group in groups])
        return centred

    q, v = mean(angles), path.averaged(velocity, followed)
    a = mean(acceleration, [path.inner(group) for group in followed])
    still = ~moves
    v[:, still] = a[:, still] = 0.0
    q[:, still] = q[:, still].mean(axis=0)
    first = v[0]
    motion = Motion(
        time=run.start_s + np.concatenate([[time[followed[0][0]] - 1.0], mean(time)]),
        q=np.concatenate([q[:1] - np.sign(first) * APPROACH, q]),
        velocity=np.concatenate([v[:1], v]),
        acceleration=np.concatenate([np.zeros_like(a[:1]), a]),
        wrench=np.concatenate([mean(wrenches)[:1], mean(wrenches)]),
        read=np.concatenate([[False], useful[shapes]]),
    )
    worst, swinging = (
        np.stack([values[group].max(axis=0) for group in kept]) for values in (error, fading(error, time, period))
    )
    worst[:, still] = swinging[:, still] = 0.0
    change = error * period / (UNRESOLVED * PEAK)  # of speed, unsteadily
    jerky = np.any(change[:, moves] > JERKY * top[moves], axis=1)
    after = time - np.maximum.accumulate(np.where(jerky, time, time[0]))  # a run may begin right after a ramp
    rings = np.array([np.any(after[group] < settling_periods() * period) for group in kept])
    felt = _drive_error(path, worst, swinging, np.where(still, 0.0, np.median(unresolved, axis=0)), period)
    excess = average_excess(compiled, path, motion)
    yield SegmentInput(run.name, kept, motion, worst, turning, rings, path, felt, excess)


def _drive_error(path: Path, worst: Array, swinging: Array, usual: Array, period: float) -> Array:
    """Return the standard deviation of accelerations as averaged torques have them, shape (2, T, n): links, rotors.

    Where torques are averaged with the weights with which accelerations are, what changes within a bin changes both
    alike. Rotors go as the motors do; what is left of their error is what steady motion has. Links ring after a jerk
    and fade, as far as the average lets their lowest mode through: an average as long as a period of it makes a slow
    wave of it that looks like anything. At the ends of a run accelerations have other weights.

    Args:
        path: Of the motion.
        worst: Shape (T, n), errors of accelerations that were not averaged alike.
        swinging: Shape (T, n), the same as long as the arm rings for them.
        usual: Shape (n,), the median of errors.
        period: Of the arm's lowest mode [s].
    """
    half, last = len(path.kernel) // 2, len(path.time) - 1
    inside = np.array([inner[0] > half and inner[-1] < last - half for inner in map(path.inner, path.groups)])
    alike = (inside & (len(path.kernel) > 1))[:, None]
    phase = [np.exp(2j * np.pi * path.time[rows] / period) for rows, _ in path.of_torque]
    through = np.abs([weights @ turned for (_, weights), turned in zip(path.of_torque, phase, strict=True)])[:, None]
    rotors = np.minimum(usual, worst)
    links = np.maximum(np.minimum(through, 1.0) * swinging, rotors)
    return np.where(alike, np.stack([links, rotors]), worst)


def settling_periods() -> float:
    """Return after how many periods of its lowest mode an arm rings no more."""
    return -math.log(FADED) / (2 * math.pi * DAMPING_RATIO)


def lowest_period(compiled: CompiledRobot, q: Array) -> float:
    """Return the period of the arm's lowest mode with its motors held at angles q, shape (n,) [s]."""
    # M x'' = -K x; the largest eigenvalue of K^-1/2 M K^-1/2 is 1 / omega^2
    root = 1 / np.sqrt(compiled.stiffness)
    return float(2 * np.pi * np.sqrt(np.linalg.eigvalsh(root[:, None] * link_mass_matrix(compiled, q) * root)[-1]))


def _unresolved(angles: Array, acceleration: Array, window: int, time: Array) -> Array:
    """Return how far an acceleration may be off, shape (rows, n): what half the resolution adds."""
    longer = _twice(window, len(angles))
    if longer <= window:
        return np.zeros_like(angles)
    return np.asarray(UNRESOLVED * np.abs(acceleration - derivative_over(angles, time, longer, 2)))


def kept_up(unresolved: Array, window: int, time: Array, period: float) -> Array:
    """Return it kept up for half a period [s] before and after: what rings after a jerk averages out of no less."""
    longer = _twice(window, len(unresolved))
    half = min(period / float(np.median(np.diff(time))) / 2, float(len(time)))  # a stranger's arm may swing for hours
    reach = max(longer, 2 * round(half) + 1)
    error: Array = maximum_filter1d(unresolved, reach, axis=0)
    return error


def fading(error: Array, time: Array, period: float) -> Array:
    """Return errors of accelerations, shape (rows, n), that fade as the lowest mode of the arm does, with `period` [s].

    Of what came before, the largest that is left counts.
    """
    faded = 2 * np.pi * DAMPING_RATIO / period * (time - time[0])[:, None]
    level = np.log(np.maximum(error, np.finfo(float).tiny)) + faded
    return np.asarray(np.exp(np.maximum.accumulate(level) - faded))


def _twice(window: int, rows: int) -> int:
    return min(2 * window + 1, 2 * ((rows - 1) // 2) - 1)
