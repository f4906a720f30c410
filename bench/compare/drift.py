"""What a machine's figures that drift from day to day took of the difference between recordings.

A drift is no change, so it is integrated out (`background.py`). What is integrated out and told is said all the same:
friction that fell by a fifth with the temperature of the day is worth a word beside what is named.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from bench.compare.background import Background
from bench.compare.comparison import NORMAL_90, Drift, Interval
from bench.compare.levels import is_of_machine
from bench.compare.search_changes import Found
from bench.diagnose.extend.told import is_told
from bench.diagnose.replay.fitted import torque_constant_of
from bench.diagnose.replay.nuisances import Nuisance
from bench.record.campaign import Array


def drifts_of(background: Background, found: Found) -> tuple[Drift, ...]:
    """Return what drifted, where the recordings tell it, beside what is named.

    With nuisances z (prior one, slopes A), changes x (slopes X, prior one) and residual r, the mean of a sum c^T z is
    w^T (r - X x), w = A (I + A^T A)^-1 c, and its variance c^T (I + A^T A)^-1 c and what x, with covariance K, is
    uncertain by: w^T X K X^T w.

    Args:
        background: All recordings.
        found: What changed.
    """
    figures = list(_drifting(background))
    if not figures:
        return ()
    known, n_after = background.nuisances, sum(one.is_after for one in background.joint.recordings)
    weights = np.concatenate([_against_before(background, places) for _, places in figures], axis=1)
    spread = known.covariance_with(weights)
    seen_by = known.jacobian @ spread
    own = [background.acting(one.entry.columns, one.profile.weights) * one.prior for one in found.best]
    columns = np.concatenate([np.empty((len(background.white), 0)), *own], axis=1)
    products = known.products(background.white, columns)
    covariance = np.linalg.inv(products.information + np.eye(columns.shape[1]))
    mean = seen_by.T @ (background.white - columns @ (covariance @ products.scores))
    pull = columns.T @ seen_by
    sigma = np.sqrt(np.sum(weights * spread, axis=0) + np.sum(pull * (covariance @ pull), axis=0))
    prior = np.sqrt(np.sum(weights**2, axis=0))
    drifts = []
    for i, (nuisance, _) in enumerate(figures):
        mine = slice(i * n_after, (i + 1) * n_after)
        variances = (sigma[mine] ** 2).tolist(), (prior[mine] ** 2).tolist()
        if any(is_told(*pair) for pair in zip(*variances, strict=True)):
            drifts.append(_drift(background, nuisance, mean[mine], sigma[mine], float(prior[mine][0])))
    return tuple(drifts)


def _drifting(background: Background) -> Iterator[tuple[Nuisance, NDArray[np.intp]]]:
    """Yield each figure of the robot that is of the day and shows in all recordings, with its column of each."""
    slopes, count = background.slopes, len(background.joint.recordings)
    for i, nuisance in enumerate(background.joint.linear.nuisances):
        if (is_of_machine(nuisance) or nuisance.edit) and nuisance.own > 0:
            places = np.flatnonzero((slopes.nuisance == i) & (slopes.recording >= 0))
            if len(places) == count:
                yield nuisance, places[np.argsort(slopes.recording[places])]


def _against_before(background: Background, places: NDArray[np.intp]) -> Array:
    """Return the weights of a figure in each recording after against the mean of those before, shape (p, n)."""
    before = np.array([not one.is_after for one in background.joint.recordings])
    weights = np.zeros((background.nuisances.jacobian.shape[1], int(np.sum(~before))))
    weights[places[before]] = -1 / np.sum(before)
    weights[places[~before], np.arange(weights.shape[1])] = 1.0
    return weights


def _drift(background: Background, nuisance: Nuisance, mean: Array, sigma: Array, prior: float) -> Drift:
    """Return a drift of which mean and standard deviation are given in those of what drifts, shape (n,) each."""
    share = nuisance.own / nuisance.sigma
    is_constant = torque_constant_of(background.joint.linear.replay.compiled, nuisance) is not None

    def off_by(x: float) -> float:
        off = nuisance.off_by(x * share)
        return 1 / (1 + off) - 1 if is_constant else off  # what a drive reports falls where its constant rises

    values = []
    for x, s in zip(mean.tolist(), sigma.tolist(), strict=True):
        low, high = sorted(off_by(x + side * NORMAL_90 * s) for side in (-1, 1))
        values.append(Interval(off_by(x), low, high))
    return Drift(nuisance.name, nuisance.unit, tuple(values), prior * nuisance.own)
