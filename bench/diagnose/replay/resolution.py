"""How finely a motion is resolved: no finer than its angles are read, and no coarser than gravity allows.

Angles are read with noise and in steps. Differentiated twice over a window of m samples that grows as m^-2.5; as a
torque it should be less than what the torques of the drives scatter over the same window, or a replay errs by what it
makes of the encoders alone. But a torque that is averaged over a window has the gravity of the whole window, and a
replay that of its middle: that difference, gravity's stiffness times the curvature of the motion, grows as m^2 and acts
as inertia does. A replay adds what the nominal model makes of it (`average_excess.py`), which is as good as its masses;
here all of it counts. Where encoders are too coarse for both to be small, the window with the least of both is taken.
"""

from collections.abc import Callable

import numpy as np
from scipy.ndimage import correlate1d

from bench.diagnose.replay.noise import UNIFORM
from bench.diagnose.replay.smooth_derivative import averaging_kernel, noise_gain
from bench.record.campaign import Array
from bench.record.moving import FEWEST_ROWS

LEAST_WINDOW = FEWEST_ROWS
FEWEST_STEPS = 8  # declared: different values, and different ways from sample to sample, by which steps are told
WHOLE = 0.1  # rounding: of a step, by which multiples of it may be off in the last digits of a log
WIDER = 1.2  # effort: ratio of neighbouring windows that are tried
# effort: of the noise of a torque, that windows may add to it: in all a thirtieth more. With a half, an eighth, a
# diagnosis of fine torque sensors predicted worse than least squares, whose low-pass adds less
SHARE = 0.25
ORDER = 6  # exact: of the differences that noise is read from; motion of 2 Hz at 100 Hz leaves 4e-6 of its size
BLOCK = 64  # effort: samples over which noise is averaged; the median block counts, so jumps do not


def angle_noise(angles: Array) -> Array:
    """Return the standard deviation of readings of motor angles, steps of the encoders included, shape (n,).

    A joint that goes on by whole steps of its encoder from sample to sample shows no noise, and errs by as much as any
    other wherever it speeds up.

    Args:
        angles: Shape (rows, n), equidistant samples.
    """
    return np.maximum(_roughness(angles), [UNIFORM * step_of(column) for column in angles.T])


def step_of(values: Array) -> float:
    """Return of what the differences between values, shape (rows,), are multiples; 0 where of nothing.

    At one constant speed samples lie evenly without any encoder, so that says nothing. Many different ways from sample
    to sample do, or single ones that are a step longer or shorter than those before and after, as of a coarse encoder
    that ticks.
    """
    every = np.unique(values)
    apart = np.diff(every)
    apart = apart[apart > np.sqrt(np.finfo(float).eps) * np.ptp(values)]  # else one value, in another last digit
    if len(apart) < FEWEST_STEPS:
        return 0.0
    step = float(np.min(apart))
    steps = (every - every[0]) / step
    is_stepped = np.all(np.abs(steps - np.rint(steps)) < WHOLE)
    if not is_stepped:
        return 0.0
    ways = np.rint(np.diff(values) / step)
    ticks = (ways[:-2] == ways[2:]) & (np.abs(ways[1:-1] - ways[2:]) == 1)
    return step if max(len(np.unique(ways)), int(np.sum(ticks))) >= FEWEST_STEPS else 0.0


def _roughness(angles: Array) -> Array:
    """Return the standard deviation of readings by their sixth differences, shape (n,)."""
    rows = len(angles) - ORDER
    if rows < BLOCK:
        return np.zeros(angles.shape[1])
    rough = np.diff(angles, ORDER, axis=0)[: rows // BLOCK * BLOCK]
    power = np.mean(rough.reshape(-1, BLOCK, angles.shape[1]) ** 2, axis=1)
    moves = power > 0  # an encoder that stands shows the same step all the time
    median = [np.median(column[there]) if there.any() else 0.0 for column, there in zip(power.T, moves.T, strict=True)]
    return np.asarray(np.sqrt(np.array(median) / _power_of_differences()))


def finest_window(
    noise: Array,
    inertia: Array,
    torque_noise: Array,
    dt: float,
    shortest: float,
    longest: float,
    missed: Callable[[int], Array] | None = None,
) -> float:
    """Return over how long to differentiate a motion, so that torques are no worse for it [s].

    Args:
        noise: Shape (n,), standard deviations of angles [rad] or [m].
        inertia: Shape (n, n), mass matrix with rotors.
        torque_noise: Shape (n,), standard deviation of a sample of each drive's torque [Nm] or [N]; nan: not read.
        dt: Between samples [s].
        shortest: [s], which will do where angles are good.
        longest: [s], which has to do.
        missed: What a window of so many samples misses of each torque, shape (n,) [Nm] or [N]; None: nothing.
    """
    window, best, least = shortest, shortest, np.inf
    while True:
        samples = max(2 * round(window / dt / 2) + 1, LEAST_WINDOW)
        felt = inertia**2 @ (noise * noise_gain(samples, 2) / dt**2) ** 2
        if missed:
            felt = felt + missed(samples) ** 2
        ratios = np.sqrt(felt) / (torque_noise * np.linalg.norm(averaging_kernel(samples)))
        ratio = float(np.max(ratios, initial=0.0, where=np.isfinite(ratios)))
        if ratio <= least:
            best, least = window, ratio
        if ratio <= SHARE or window >= longest:
            return best
        window = min(WIDER * window, longest)


def missed_by_average(angles: Array, stiffness: Array, window: int) -> Array:
    """Return by how much gravity in the middle of a window misses its average (RMS), shape (n,) [Nm] or [N].

    Args:
        angles: Shape (rows, n), equidistant samples.
        stiffness: Shape (n, n), derivative of gravity torques with the angles.
        window: Samples.
    """
    kernel = averaging_kernel(window)
    half = len(kernel) // 2
    if len(angles) <= 2 * half:
        return np.zeros(angles.shape[1])
    beside = (correlate1d(angles, kernel, axis=0) - angles)[half : len(angles) - half]
    return np.asarray(np.sqrt(np.mean((beside @ stiffness.T) ** 2, axis=0)))


def _power_of_differences() -> float:
    """Return the variance of differences of white noise with variance 1."""
    impulse = np.zeros(2 * ORDER + 1)
    impulse[ORDER] = 1.0
    return float(np.sum(np.diff(impulse, ORDER) ** 2))
