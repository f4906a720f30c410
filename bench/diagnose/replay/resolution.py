"""How finely a motion is resolved: no finer than its angles are read.

Angles are read with noise and in steps. Differentiated twice over a window of m samples that grows as m^-2.5; as a
torque it should be less than what the torques of the drives scatter over the same window, or a replay errs by what it
makes of the encoders alone.
"""

import numpy as np

from bench.diagnose.replay.smooth_derivative import averaging_kernel, noise_gain
from bench.record.campaign import Array

LEAST_WINDOW = 5  # exact: samples
WIDER = 1.2  # effort: ratio of neighbouring windows that are tried
SHARE = 0.5  # effort: of the noise of a torque, that angles may add to it: in all an eighth more
ORDER = 6  # exact: of the differences that noise is read from; motion of 2 Hz at 100 Hz leaves 4e-6 of its size
BLOCK = 64  # effort: samples over which noise is averaged; the median block counts, so jumps do not


def angle_noise(angles: Array) -> Array:
    """Return the standard deviation of readings of motor angles, steps of the encoders included, shape (n,).

    Args:
        angles: Shape (rows, n), equidistant samples.
    """
    rows = len(angles) - ORDER
    if rows < BLOCK:
        return np.zeros(angles.shape[1])
    rough = np.diff(angles, ORDER, axis=0)[: rows // BLOCK * BLOCK]
    power = np.mean(rough.reshape(-1, BLOCK, angles.shape[1]) ** 2, axis=1)
    moves = power > 0  # an encoder that stands shows the same step all the time
    median = [np.median(column[there]) if there.any() else 0.0 for column, there in zip(power.T, moves.T, strict=True)]
    return np.asarray(np.sqrt(np.array(median) / _power_of_differences()))


def finest_window(
    noise: Array, inertia: Array, torque_noise: Array, dt: float, shortest: float, longest: float
) -> float:
    """Return over how long to differentiate a motion, so that torques are no worse for it [s].

    Args:
        noise: Shape (n,), standard deviations of angles [rad] or [m].
        inertia: Shape (n, n), mass matrix with rotors.
        torque_noise: Shape (n,), standard deviation of a sample of each drive's torque [Nm] or [N]; nan: not read.
        dt: Between samples [s].
        shortest: [s], which will do where angles are good.
        longest: [s], which has to do.
    """
    window = shortest
    while window < longest:
        samples = max(2 * round(window / dt / 2) + 1, LEAST_WINDOW)
        felt = np.sqrt(inertia**2 @ (noise * noise_gain(samples, 2) / dt**2) ** 2)
        if not np.any(felt > SHARE * torque_noise * np.linalg.norm(averaging_kernel(samples))):
            break
        window = min(WIDER * window, longest)
    return window


def _power_of_differences() -> float:
    """Return the variance of differences of white noise with variance 1."""
    impulse = np.zeros(2 * ORDER + 1)
    impulse[ORDER] = 1.0
    return float(np.sum(np.diff(impulse, ORDER) ** 2))
