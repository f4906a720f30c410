"""How far sizes of findings scatter from run to run: standard errors that do not rely on the model being right.

Least squares states how well a size is known if nothing but the noise acts. Where a model is a little wrong
everywhere, runs disagree by more than that, and leaving out one after the other shows it (the jackknife over groups;
Efron, The jackknife, the bootstrap and other resampling plans, 1982, chapter 3). What is stated is the larger of the
two.

Beside a block of a run its neighbours are left out too, so a fold takes more with it than its own share. Without that
share s an estimate moves by s / (1 - s) of its variance, so squares count by (1 - s) / s each (Busing, Meijer and van
der Leeden, Delete-m jackknife for unequal m, 1999), which is K - 1 where K groups are left out one by one.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from bench.diagnose.cross_validation.folds import ALONE, folds_of
from bench.diagnose.cross_validation.leave_out import Tangent, step_without, tangent_of
from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.record.campaign import Array


def with_jackknife(linear: LinearisedModel, fit: Fit) -> Fit:
    """Return a fit whose standard errors are no smaller than the scatter of its sizes between runs.

    Correlations stay. Recordings count in place of runs where there are several, and blocks of the only run. A size
    that one of them shows nearly alone keeps its standard error: no other can tell it.

    Args:
        linear: The campaign, with the background errors of the fit.
        fit: To all of it.
    """
    if not len(fit.values):
        return fit
    p = len(fit.nuisances)
    variance = jackknife_variance(tangent_of(linear, fit), *folds_of(linear).of_rows(linear), p)
    stated = np.diag(fit.covariance)
    wider = np.sqrt(np.maximum(variance / stated, 1.0, where=stated > 0, out=np.ones_like(stated)))
    return replace(fit, covariance=fit.covariance * np.outer(wider, wider))


def jackknife_variance(
    tangent: Tangent, row_fold: NDArray[np.int64], row_gap: NDArray[np.bool_], first: int = 0
) -> Array:
    """Return the variance of parameters by leaving out fold after fold, shape (p + k - first,).

    What priors hold a parameter back by does not show between folds; its variance is added. 0 where one fold shows
    nearly all that is known of a parameter, and for one that stays at its bound.

    Args:
        tangent: A fit in the linearised model.
        row_fold: Shape (m,), of each reading.
        row_gap: Shape (m, K), readings that are left out beside each of K folds.
        first: Index of the first parameter that is asked for.
    """
    free = tangent.free
    asked = free >= first
    jacobian, precision, unit = tangent.jacobian[:, free], tangent.free_precision, np.eye(len(free))[:, asked]
    known = cho_solve(cho_factor(precision), unit)
    moves, is_alone = _left_out(tangent, row_fold, row_gap, known, unit)
    scatter = np.sum(moves[:, asked] ** 2, axis=0)
    prior = np.diag(precision) - np.einsum("ij,ij->j", jacobian, jacobian)
    variance = scatter + np.maximum(prior, 0.0) @ known**2
    found = np.zeros(tangent.jacobian.shape[1] - first)
    found[free[asked] - first] = np.where(is_alone, 0.0, variance)
    return found


def jackknife_covariance(tangent: Tangent, row_fold: NDArray[np.int64], row_gap: NDArray[np.bool_]) -> Array:
    """Return how parameters vary together where fold after fold is left out, shape (p + k, p + k).

    Without what priors hold back; 0 for what one fold shows nearly alone. What is fitted to all other folds predicts
    much the same of them, so what parameters do together varies far less than each of them.

    Args:
        tangent: A fit in the linearised model.
        row_fold: Shape (m,), of each reading.
        row_gap: Shape (m, K), readings that are left out beside each of K folds.
    """
    free, unit = tangent.free, np.eye(len(tangent.free))
    moves, is_alone = _left_out(tangent, row_fold, row_gap, cho_solve(cho_factor(tangent.free_precision), unit), unit)
    moves[:, is_alone] = 0.0
    found = np.zeros((tangent.jacobian.shape[1],) * 2)
    found[np.ix_(free, free)] = moves.T @ moves
    return found


def _left_out(
    tangent: Tangent, row_fold: NDArray[np.int64], row_gap: NDArray[np.bool_], known: Array, unit: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Return by how much free parameters move without each fold, by the root of its weight, and which one shows alone.

    Args:
        tangent: A fit in the linearised model.
        row_fold: Shape (m,), of each reading.
        row_gap: Shape (m, K), readings that are left out beside each of K folds.
        known: Shape (f, a), columns of the covariance of all.
        unit: Shape (f, a), which those are.

    Returns:
        Shape (K, f), and (a,).
    """
    free, count = tangent.free, row_gap.shape[1]
    jacobian, precision = tangent.jacobian[:, free], tangent.free_precision
    own = np.einsum("ij,ij->j", known, unit)
    moves, is_alone = np.zeros((count, len(free))), np.zeros(len(own), dtype=bool)
    for f in range(count):
        mine = row_fold == f
        if not mine.any():
            continue
        absent = mine | row_gap[:, f]
        share = min(absent.sum() / (mine.sum() * count), 1.0)  # folds count alike, for runs differ in what they tell
        step, rest = step_without(jacobian[absent], tangent.white[absent], precision)
        moves[f] = np.sqrt((1 - share) / share / count) * step
        without = np.einsum("ij,ij->j", cho_solve(rest, unit), unit)
        is_alone |= own < (1 - ALONE) * without
    return moves, is_alone
