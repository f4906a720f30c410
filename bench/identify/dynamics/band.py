"""The filter that model and data pass alike, chosen from the spectrum of the motion.

Parallel filtering (M. Gautier, "Dynamic identification of robots with power model", ICRA 1997): positions pass a
zero-phase low-pass and are differentiated; then every column of the regression and the torque pass one and the same
zero-phase low-pass and are thinned to twice its cut-off. Derivatives are those of cubic splines: at a quarter of the
sampling rate central differences lose 36 % of a velocity and 59 % of an acceleration, splines 4.5 and 9 %.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.interpolate import CubicSpline

from bench.errors import InputError
from bench.identify.dynamics.samples import MotionSamples
from bench.record.campaign import Array
from bench.record.moving import TRAVELS

BANDWIDTH = 0.99  # derived: of the velocity's power lies below the bandwidth (occupied bandwidth, ITU-R SM.443)
TORQUE_CUTOFF = 10.0  # derived: bandwidths up to which columns and torque are kept (IDIM-LS, Gautier and Janot)
# derived: times that, so that differentiation does not shape what is kept (likewise)
POSITION_CUTOFF = 2.0
ORDER = 4  # derived: of each Butterworth filter, run forth and back (likewise)
LEAST = 30  # declared: samples that are kept of all runs; fewer are refused, for they tell no drive from its friction
MOST_FILTERS = 64  # effort: that are kept
HIGHEST = 0.8  # rounding: of half the sampling rate; a cut-off beyond that filters nothing


@dataclass(frozen=True)
class Band:
    """The stated filter.

    Attributes:
        cutoff_hz: Of columns and torque [Hz]; the thinned data have about twice that rate.
        bandwidth_hz: Of the motion [Hz], with 99 % of its velocity's power below; nan if the cut-off was given.
    """

    cutoff_hz: float
    bandwidth_hz: float

    @property
    def position_cutoff_hz(self) -> float:
        """Of the positions [Hz]."""
        return POSITION_CUTOFF * self.cutoff_hz

    def smooth(self, samples: MotionSamples) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration of a stretch, none of them late, each of shape (T, n)."""
        position = low_pass(samples.position, samples.rate, self.position_cutoff_hz)
        velocity = derivative(position, samples.rate)
        return position, velocity, derivative(velocity, samples.rate)

    def kept(self, samples: MotionSamples) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
        """Return the indices of the samples that are kept after filtering.

        At either end one period of the cut-off is left out: there the filters see past the record.
        """
        period = min(samples.rate / self.cutoff_hz, float(len(samples)))  # in samples
        every, edge = max(1, int(period / 2)), int(np.ceil(period))
        return np.arange(edge, len(samples) - edge, every)

    def filtered(self, values: Array, samples: MotionSamples) -> Array:
        """Return columns of a stretch, shape (T, ...), low-passed and thinned."""
        return np.asarray(low_pass(values, samples.rate, self.cutoff_hz)[self.kept(samples)])


def derivative(values: Array, rate: float) -> Array:
    """Return the derivative over time of evenly sampled columns, shape (T, n) [1/s of their unit], by cubic splines."""
    time = np.arange(len(values)) / rate
    return np.asarray(CubicSpline(time, values)(time, 1))


def low_pass(values: Array, rate: float, cutoff_hz: float) -> Array:
    """Return values, shape (T, ...), through a zero-phase Butterworth low-pass; as they are where it lies too high."""
    if cutoff_hz >= HIGHEST * rate / 2:
        return values
    from scipy.signal import sosfiltfilt  # here: half a second that who needs none need not wait

    sections = _butterworth(cutoff_hz / (rate / 2))
    pad = min(len(values) - 1, int(np.ceil(rate / cutoff_hz)) + 3 * (2 * len(sections) + 1))
    return np.asarray(sosfiltfilt(sections, values, axis=0, padlen=pad))


@lru_cache(maxsize=MOST_FILTERS)
def _butterworth(cutoff: float) -> Array:
    """Return the sections of a low-pass with a cut-off in half sampling rates."""
    from scipy.signal import butter

    return np.asarray(butter(ORDER, cutoff, output="sos"))


def band_of(runs: Sequence[MotionSamples], cutoff_hz: float | None = None) -> Band:
    """Return the filter for a campaign: as stated, or ten times the bandwidth of its motion.

    The bandwidth is read from the commands, which are not noisy, and from the encoders where no command was logged.

    Raises:
        InputError: The cut-off is not positive, or beyond half the sampling rate of all runs; or nothing moves.
    """
    if cutoff_hz is not None:
        if not cutoff_hz > 0:
            raise InputError(f"cut-off {cutoff_hz:g} Hz: must be positive.")
        if cutoff_hz >= (highest := max(run.rate for run in runs) / 2):
            raise InputError(
                f"cut-off {cutoff_hz:g} Hz: lies above half of the sampling rate, {highest:g} Hz; give less, or leave "
                "it out."
            )
        band = Band(cutoff_hz, np.nan)
        if sum(len(band.kept(run)) for run in runs) < LEAST:
            longest = max(len(run) / run.rate for run in runs)
            raise InputError(f"cut-off {cutoff_hz:g} Hz: leaves next to nothing of runs of {longest:.3g} s; give more.")
        return band
    velocities = [_commanded_velocity(run) for run in runs]
    top = np.max([np.abs(velocity).max(axis=0) for velocity in velocities], axis=0)
    travel = np.max([np.ptp(run.position, axis=0) for run in runs], axis=0)
    moves = (top > 0) & (travel > TRAVELS)
    scale = np.where(moves, 1 / np.where(moves, top, 1.0), 0.0)  # each joint counts by its own top speed
    spectra = (_spectrum(v * scale, run.rate) for v, run in zip(velocities, runs, strict=True))
    frequency, power = zip(*spectra, strict=True)
    edges = np.unique(np.concatenate(frequency))
    total = sum(np.interp(edges, f, np.cumsum(p)) for f, p in zip(frequency, power, strict=True))
    if not total[-1] > 0:
        raise InputError("method 'dynamics' needs joints that move; all stand still in this campaign.")
    bandwidth = float(edges[np.argmax(total >= BANDWIDTH * total[-1])])
    slowest = min(len(run) / run.rate for run in runs)
    bandwidth = max(bandwidth, 1 / slowest)
    return Band(TORQUE_CUTOFF * bandwidth, bandwidth)


def _commanded_velocity(run: MotionSamples) -> Array:
    path = np.where(np.isfinite(run.command).all(axis=0), run.command, run.position)
    return np.asarray(np.diff(path, axis=0) * run.rate)


def _spectrum(velocity: Array, rate: float) -> tuple[Array, Array]:
    """Return frequencies [Hz], and the energy of all velocities there, less what white noise of the angles adds.

    Steps of an encoder, differentiated, have a power that rises with the frequency: of slow motion that is more than
    1 %, and would pass for its bandwidth. Its level is that of the upper half of all frequencies, where no motion is.
    """
    from scipy.signal import periodogram  # here: half a second that who needs none need not wait

    frequency, power = periodogram(velocity, rate, window="hann", detrend=False, axis=0)
    differentiated = np.sin(np.pi * frequency / rate)[:, None] ** 2
    upper = frequency > rate / 4
    level = power[upper].sum(axis=0) / differentiated[upper].sum()
    return frequency, np.asarray((power - level * differentiated).sum(axis=1) * len(velocity))
