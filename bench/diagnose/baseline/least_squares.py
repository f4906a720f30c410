"""What least squares predicts of the bins of a replay, each while it was held out."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.cross_validation.folds import Folds
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.instants import instants_of
from bench.identify.dynamics import folds as dynamics
from bench.identify.dynamics.averages import Averages, averages_of
from bench.identify.dynamics.found import FirstPass
from bench.record.campaign import Array

MODELS = {"plain_least_squares": "rival", "first_pass": "first_pass"}  # names here -> those of the first pass

Index = NDArray[np.int64]


def least_squares_at_bins(linear: LinearisedModel, first: FirstPass, folds: Folds) -> dict[str, Array]:
    """Return the torques that least squares predicts of each instant of a campaign, fitted without its fold.

    Args:
        linear: The campaign; T instants.
        first: The first pass over it; n drives.
        folds: What is held out at a time.

    Returns:
        "plain_least_squares" and "first_pass" -> shape (T, n) [Nm]; nan at rest, where a drive stands or turns round,
        and beside lost samples.
    """
    found = {name: np.full((len(folds.of_instants), len(first.joints)), np.nan) for name in MODELS}
    bins = list(_bins(linear, first))
    for fold, parameters in enumerate(first.problems.without(_alike(linear, first, folds))):
        for instants, averages in bins:
            mine = folds.of_instants[instants] == fold
            for name, model in MODELS.items():
                if mine.any():
                    found[name][instants[mine]] = averages.torque(parameters[model])[mine]
    return found


def _bins(linear: LinearisedModel, first: FirstPass) -> Iterator[tuple[Index, Averages]]:
    """Yield instants of the campaign, and what predicts them, piece by piece."""
    every = np.arange(len(linear.residual))
    for segment, mine in zip(linear.segments, instants_of(linear.segments), strict=True):
        if segment.path is None or segment.is_static:
            continue
        path, instants = segment.path, every[mine]
        averaged = [(path.time[rows], weights) for rows, weights in path.of_torque]
        for averages in averages_of(first, segment.run, averaged):
            yield instants[averages.which], averages


def _alike(linear: LinearisedModel, first: FirstPass, folds: Folds) -> dynamics.Folds:
    """Return the same folds over the equations of the first pass: each instant is in that of the bin nearest in time.

    Runs of which a replay reads nothing are never held out.
    """
    time: dict[str, list[Array]] = {}
    instants: dict[str, list[Index]] = {}
    every = np.arange(len(linear.residual))
    for segment, mine in zip(linear.segments, instants_of(linear.segments), strict=True):
        if segment.path is not None and not segment.is_static:
            middle = [segment.path.time[group].mean() for group in segment.path.groups]
            time.setdefault(segment.run, []).append(np.array(middle))
            instants.setdefault(segment.run, []).append(every[mine])
    of, near = [], []
    for part in first.stretches:
        if part.samples.run not in time:
            of.append(np.full(len(part), -1))
            near.append(np.zeros((len(part), len(folds)), dtype=np.bool_))
            continue
        known = np.concatenate(time[part.samples.run])
        borders = (known[1:] + known[:-1]) / 2
        nearest = np.concatenate(instants[part.samples.run])[np.searchsorted(borders, part.time)]
        of.append(folds.of_instants[nearest])
        near.append(folds.gap[nearest])
    return dynamics.Folds(folds.by, tuple(map(str, range(len(folds)))), tuple(of), tuple(near), repeats=False)
