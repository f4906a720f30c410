"""How far sizes of findings scatter from run to run: standard errors that do not rely on the model being right.

Least squares states how well a size is known if nothing but the noise acts. Where a model is a little wrong
everywhere, runs disagree by more than that, and leaving out one after the other shows it (the jackknife over groups;
Efron, The jackknife, the bootstrap and other resampling plans, 1982, chapter 3). What is stated is the larger of the
two.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

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
    variance = jackknife_variance(tangent_of(linear, fit), *folds_of(linear).of_rows(linear))
    stated, found = np.diag(fit.covariance), variance[len(fit.nuisances) :]
    wider = np.sqrt(np.maximum(found / stated, 1.0, where=stated > 0, out=np.ones_like(stated)))
    return replace(fit, covariance=fit.covariance * np.outer(wider, wider))


def jackknife_variance(tangent: Tangent, row_fold: NDArray[np.int64], row_gap: NDArray[np.bool_]) -> Array:
    """Return the variance of all parameters by leaving out fold after fold, shape (p + k,).

    What priors hold a parameter back by does not show between folds; its variance is added. 0 where one fold shows
    nearly all that is known of a parameter.

    Args:
        tangent: A fit in the linearised model.
        row_fold: Shape (m,), of each reading.
        row_gap: Shape (m, K), readings that are left out beside each of K folds.
    """
    every, count = np.arange(tangent.jacobian.shape[1]), row_gap.shape[1]
    known = np.linalg.inv(tangent.precision)
    steps, is_alone = [], np.zeros(len(every), dtype=bool)
    for f in range(count):
        step, rest = step_without(tangent, tangent.white, (row_fold == f) | row_gap[:, f], every)
        steps.append(step)
        is_alone |= np.diag(known) < (1 - ALONE) * np.diag(np.linalg.inv(rest))
    scatter = (count - 1) / count * np.sum(np.square(steps), axis=0)
    prior = np.diag(tangent.precision) - np.einsum("ij,ij->j", tangent.jacobian, tangent.jacobian)
    return np.where(is_alone, 0.0, scatter + known**2 @ np.maximum(prior, 0.0))
