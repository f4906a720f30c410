"""What a fitted model will leave of a recording that nobody has made yet: an interval for each channel."""

from collections.abc import Mapping
from typing import Literal

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from scipy.special import stdtrit

from bench.diagnose.cross_validation.folds import Folds, folds_of
from bench.diagnose.cross_validation.held_out import HIGH, LOW, SEED, PredictedError
from bench.diagnose.cross_validation.leave_out import errors_of_folds, tangent_of
from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.alike import ALIKE, passes_same
from bench.diagnose.replay.segments import recordings_of
from bench.record.campaign import Array

DRAWS = 4000  # effort: of recordings to come: ends of an interval are right to a few percent of its width
# rounding: of a root mean square that is drawn, so that its square is a number: far beyond the quantiles
MOST_LOG = 300.0


def predicted_error(linear: LinearisedModel, fit: Fit) -> tuple[PredictedError, ...]:
    """Return what a fitted model will leave of an unseen recording of the same robot, for static runs and for motion.

    Each run of the campaign is predicted by the model as fitted to the others. The logarithms of their root mean
    squares are taken as normal: one more run lies around their mean with s sqrt(1 + 1/K) and Student's t of K - 1
    degrees of freedom. A campaign of one run is cut into blocks that stand for runs; blocks that pass the same places,
    there and back, are held out together, for another motion passes other places. Of several recordings, each stands
    for a run, and what is its own (the zero of an encoder) is fitted to it.

    How far two recordings differ, one recording cannot tell. Then what drifts from one to the next (`Nuisance.drift`)
    comes on top of the squares: torque constants and viscous friction by the temperature of the day, zeros by the part
    of them that drifts. So does what is set up anew (a tracker, the zero of a link encoder), unless it will be fitted.

    Args:
        linear: The campaign.
        fit: The model.
    """
    folds = apart(linear, folds_of(linear))
    error = errors_of_folds(linear, fit, tangent_of(linear, fit), folds)
    drifts = {} if folds.recordings else drifts_of(linear)
    set_up = set_up_anew(linear, fit)
    is_static = np.repeat([s.is_static for s in linear.segments], [len(s) for s in linear.segments])
    kinds: tuple[tuple[Literal["static", "motion"], Array], ...] = (("static", is_static), ("motion", ~is_static))
    found = []
    for c, quantity in enumerate(linear.quantities):
        if quantity.is_known:
            continue  # no recording to come has it
        for kind, chosen in kinds:
            seen = chosen & np.isfinite(error[:, c])
            count = folds.sums(seen.astype(np.float64))
            square = folds.sums(np.where(seen, error[:, c], 0.0) ** 2)
            there = count > 0
            if not np.any(there):
                continue
            rms = float(np.sqrt(square.sum() / count.sum()))
            left = np.sqrt(square[there] / count[there])
            drifting, anew = (
                np.array([np.sqrt(np.mean(change[seen, c] ** 2)) for change in changes.values()])
                for changes in (drifts, set_up)
            )
            ends = (*_one_more(left, np.concatenate([drifting, anew])), *_one_more(left, drifting))
            found.append(PredictedError(quantity.column, quantity.unit, kind, int(there.sum()), rms, *ends))
    return tuple(found)


def drifts_of(linear: LinearisedModel) -> Mapping[str, Array]:
    """Return what each thing that drifts changes in the readings from one recording to the next, shape (T, c) each."""
    return {
        nuisance.name: linear.sensitivities[:, :, i] * (nuisance.drift / nuisance.sigma)
        for i, nuisance in enumerate(linear.nuisances)
        if nuisance.drift > 0
    }


def set_up_anew(linear: LinearisedModel, fit: Fit) -> Mapping[str, Array]:
    """Return what each thing that is set up anew changes in the readings, shape (T, c) each.

    In the next recording it is off by as much as is stated, and no more by what it was off in this one; of several
    recordings the model has that of the last.

    Args:
        linear: The campaign.
        fit: The model.
    """
    last = recordings_of(linear.segments)[-1]
    found = {}
    for i, nuisance in enumerate(linear.nuisances):
        if nuisance.between == "anew" and nuisance.recording in (None, last):
            change = linear.sensitivities[:, :, i] * np.sqrt(1 + fit.nuisances[i] ** 2)
            found[nuisance.name] = change
    return found


def apart(linear: LinearisedModel, folds: Folds) -> Folds:
    """Return folds of which no two blocks pass the same places; others as they are.

    Args:
        linear: The campaign.
        folds: Of it.
    """
    if folds.by != "block":
        return folds
    q = np.concatenate([segment.motion.q[segment.motion.read] for segment in linear.segments])
    spread = np.ptp(q, axis=0)
    places = (q / np.where(spread > 0, ALIKE * spread, 1.0))[:, spread > 0]
    blocks = [np.flatnonzero(folds.of_instants == f) for f in range(len(folds))]
    trees = [cKDTree(places[rows]) for rows in blocks]
    meets = np.zeros((len(folds), len(folds)), dtype=bool)
    for i, rows in enumerate(blocks):
        for j, tree in enumerate(trees):
            meets[i, j] = passes_same(places[rows], tree)
    count, group = connected_components(csr_array(meets), directed=False)
    if count < 2:  # all of it is one place: then blocks of time are what there is
        return folds
    fold = group[folds.of_instants].astype(np.int64)
    gap = np.stack([np.any(folds.gap[:, group == g], axis=1) & (fold != g) for g in range(count)], axis=1)
    return Folds("block", fold, gap)


def _one_more(rms: Array, drifting: Array) -> tuple[float, float]:
    """Return the 90 % prediction interval of one more root mean square; nan if K < 2.

    Args:
        rms: Shape (K,), log-normal.
        drifting: Shape (d,), root mean squares of what each drift changes at one standard deviation, independent.
    """
    k = len(rms)
    if k < 2 or not np.all(rms > 0):
        return np.nan, np.nan
    logs = np.log(rms)
    spread = logs.std(ddof=1) * np.sqrt(1 + 1 / k)
    if not np.any(drifting):
        half = float(stdtrit(k - 1, HIGH)) * spread
        return float(np.exp(logs.mean() - half)), float(np.exp(logs.mean() + half))
    rng = np.random.default_rng(SEED)
    more = logs.mean() + spread * rng.standard_t(k - 1, DRAWS)
    square = np.exp(2 * np.minimum(more, MOST_LOG)) + rng.standard_normal((DRAWS, len(drifting))) ** 2 @ drifting**2
    low, high = np.sqrt(np.quantile(square, (LOW, HIGH))).tolist()
    return low, high
