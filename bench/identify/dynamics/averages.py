"""What a first pass predicts of torques averaged over groups of samples, such as the bins of a replay."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from bench.identify.dynamics.band import Band
from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.rows import DriveRows
from bench.identify.dynamics.samples import MotionSamples
from bench.record.campaign import Array

UNFILTERED = np.inf  # [Hz]


@dataclass(frozen=True)
class Group:
    """Samples that are read as one.

    Attributes:
        samples: Indices of the samples in their stretch.
        weights: Of each; they add up to 1.
    """

    samples: NDArray[np.int64]
    weights: Array


@dataclass(frozen=True)
class Averaging(Band):
    """Averages in the place of the low-pass and its thinning; positions are smoothed as the first pass has them.

    Attributes:
        smoothing: The filter of the first pass.
        groups: What is averaged.
    """

    smoothing: Band
    groups: tuple[Group, ...]

    @property
    def position_cutoff_hz(self) -> float:
        """Of the positions [Hz]."""
        return self.smoothing.position_cutoff_hz

    def smooth(self, samples: MotionSamples) -> tuple[Array, Array, Array]:
        """Return position, velocity and acceleration of a stretch, each of shape (T, n)."""
        return self.smoothing.smooth(samples)

    def kept(self, samples: MotionSamples) -> NDArray[np.int64]:
        """Return the sample in the middle of each group."""
        return np.array([group.samples[len(group.samples) // 2] for group in self.groups], dtype=np.int64)

    def filtered(self, values: Array, samples: MotionSamples) -> Array:
        """Return the average of columns of a stretch, shape (T, ...), over each group."""
        return np.stack([np.tensordot(group.weights, values[group.samples], axes=1) for group in self.groups])


@dataclass(frozen=True)
class Averages:
    """Averaged torques as the parameters of a first pass predict them.

    Attributes:
        rows: Equations of each drive.
        which: Indices of the G groups that a first pass predicts, of all that were asked for.
    """

    rows: tuple[DriveRows, ...]
    which: NDArray[np.int64]

    def torque(self, parameters: Array) -> Array:
        """Return the torques that parameters, shape (p,), predict, shape (G, n) [Nm]; nan where a drive stands."""
        found = np.full((len(self.which), len(self.rows)), np.nan)
        for j, rows in enumerate(self.rows):
            found[rows.instant, j] = rows.model(parameters) + rows.known
        return found


def averages_of(found: FirstPass, run: str, groups: Sequence[tuple[Array, Array]]) -> tuple[Averages, ...]:
    """Return what a first pass predicts of averages within one of its runs, stretch by stretch.

    Left out are groups across a lost sample, and those within a period of the cut-off from an end of a stretch, where
    its filters see past the record.

    Args:
        found: The first pass.
        run: Name of the run.
        groups: Times [s] of the samples of each group, and their weights.
    """
    return tuple(
        averages
        for part in found.stretches
        if part.samples.run == run
        if (averages := _averages(found, part.samples, groups))
    )


def _averages(found: FirstPass, samples: MotionSamples, groups: Sequence[tuple[Array, Array]]) -> Averages | None:
    edge = int(np.ceil(samples.rate / found.band.cutoff_hz))
    inside = slice(edge, len(samples) - edge)
    if len(samples.time[inside]) == 0:
        return None
    first, last = samples.time[inside][[0, -1]]
    which = [k for k, (time, _) in enumerate(groups) if first <= time[0] and time[-1] <= last]
    if not which:
        return None
    chosen = [groups[k] for k in which]
    own = tuple(Group(np.searchsorted(samples.time, time), weights) for time, weights in chosen)
    averaging = Averaging(UNFILTERED, found.band.bandwidth_hz, found.band, own)
    earlier = CubicSpline(samples.time, samples.position)(samples.time - found.solution.delay)
    late = replace(samples, position=earlier) if found.solution.delay else samples
    return Averages(found.rows([found.equations(late, averaging)], averaging), np.array(which, dtype=np.int64))
