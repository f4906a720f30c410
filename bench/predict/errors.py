"""Errors of a prediction, by channel and by stretch."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.cross_validation.predicted_error import PredictedError
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.instants import at_each_instant, instants_of
from bench.predict.prediction import ChannelError, Stretch
from bench.record.campaign import Array
from bench.record.held_out import BLOCKS


def channel_errors(
    linear: LinearisedModel,
    error: Array,
    nominal: Array,
    noise: Array,
    promises: Sequence[PredictedError],
    is_fitted: NDArray[np.bool_] | None = None,
) -> tuple[ChannelError, ...]:
    """Return what a model leaves of every channel, at rest and in motion, beside what was promised.

    Root mean squares are plain ones over rests and bins of motion, as those of the promises are.

    Args:
        linear: The recording.
        error: Shape (T, c), measured less predicted; nan where not measured.
        nominal: Shape (T, c), the same of the nominal robot.
        noise: Shape (T, c), standard deviation of what no model can predict.
        promises: Of the model.
        is_fitted: Shape (c,), whether something that was fitted to the recording changes the channel: then all that is
            set up anew is no excuse for an error of it. None: nothing was fitted.
    """
    promised = {(one.channel, one.kind): one for one in promises}
    observed = linear.observed
    found = []
    for kind, chosen in _by_kind(linear):
        for c, quantity in enumerate(linear.quantities):
            rows = chosen & np.isfinite(error[:, c])
            if not np.any(rows):
                continue
            promise = promised.get((quantity.column, kind))
            low = high = np.nan
            if promise:
                low, high = promise.low, promise.high
                if is_fitted is not None and is_fitted[c]:
                    low, high = promise.fitted_low, promise.fitted_high
            found.append(
                ChannelError(
                    channel=quantity.column,
                    unit=quantity.unit,
                    kind=kind,
                    readings=int(rows.sum()),
                    rms=rms(error[rows, c]),
                    nominal=rms(nominal[rows, c]),
                    floor=rms(noise[rows, c]),
                    measured=quantity.size(observed[rows, c], np.ones(int(rows.sum()))),
                    low=low,
                    high=high,
                )
            )
    return tuple(found)


def worst_stretches(
    linear: LinearisedModel, error: Array, noise: Array, starts: Mapping[str, float]
) -> tuple[Stretch, ...]:
    """Return the worst stretch of each channel, that which is furthest above what no model can predict first.

    A stretch is a visit at rest, or an eighth of a run in motion: as long as the blocks that promises rest on where
    there was one run. What is known besides is none.

    Args:
        linear: The recording.
        error: Shape (T, c), measured less predicted; nan where not measured.
        noise: Shape (T, c), standard deviation of what no model can predict.
        starts: Name of each run -> when it began, on the clock of the recording [s].
    """
    stretches = list(_stretches(linear))
    time = np.concatenate([segment.motion.time[segment.motion.read] for segment in linear.segments])
    found = []
    for c, quantity in enumerate(linear.quantities):
        best: Stretch | None = None
        for run, label, rows in stretches:
            seen = rows[np.isfinite(error[rows, c])]
            if len(seen) == 0:
                continue
            left, floor = rms(error[seen, c]), rms(noise[seen, c])
            if best is None or left * best.floor > best.rms * floor:
                best = Stretch(
                    run=run,
                    label=label,
                    start_s=float(time[rows[0]]) - starts[run],
                    end_s=float(time[rows[-1]]) - starts[run],
                    first=int(rows[0]),
                    last=int(rows[-1]),
                    channel=quantity.column,
                    unit=quantity.unit,
                    rms=left,
                    floor=floor,
                )
        if best:
            found.append(best)
    return tuple(sorted(found, key=lambda one: -one.rms / one.floor))


def rms(values: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def _by_kind(linear: LinearisedModel) -> Iterator[tuple[Literal["static", "motion"], NDArray[np.bool_]]]:
    still = at_each_instant(linear.segments, [segment.is_static for segment in linear.segments])
    yield "static", still
    yield "motion", ~still


def _stretches(linear: LinearisedModel) -> Iterator[tuple[str, str, NDArray[np.int64]]]:
    """Yield run, label and instants of every visit and of the parts of every run in motion."""
    moving: dict[str, list[int]] = {}
    every = np.arange(len(linear.residual))
    for segment, mine in zip(linear.segments, instants_of(linear.segments), strict=True):
        rows = every[mine]
        if segment.is_static:
            yield segment.run, segment.label, rows
        elif not segment.is_known:
            moving.setdefault(segment.run, []).extend(rows.tolist())
    for run, instants in moving.items():
        for rows in np.array_split(np.array(instants, dtype=np.int64), min(BLOCKS, len(instants))):
            yield run, run, rows
