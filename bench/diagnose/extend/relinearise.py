"""A fit again, with derivatives of the nuisances as they are about it."""

import numpy as np

from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.objective import TELLS, Objective
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.linearised_model import LinearisedModel, relinearised
from bench.errors import NOT_SIMULATED

TINY = 1e-300  # rounding: for a column of zeros, so that nothing is divided by zero
MOST_AKIN = 5  # effort: nuisances for each cause whose derivatives are taken anew
AKIN = 0.3  # effort: cosine of their slopes


def relinearised_fit(linear: LinearisedModel, fit: Fit) -> tuple[LinearisedModel, Fit]:
    """Return a fit again, with new derivatives of the nuisances that act as its causes do; and the design with them.

    Where friction has become half as large again, so has what its uncertainty does. Where that finds no balance, the
    fit stays as it is.
    """
    try:
        return _relinearised_fit(linear, fit)
    except NOT_SIMULATED:
        return linear, fit


def _relinearised_fit(linear: LinearisedModel, fit: Fit) -> tuple[LinearisedModel, Fit]:
    which = _akin(linear, fit)
    if not which:
        return linear, fit
    renewed = Objective(linear, fit.causes).of_nuisances(fit.nuisances, fit.values, which)
    about = relinearised(linear, list(renewed), np.stack(list(renewed.values()), axis=2))
    return about, refit(about, fit.causes, fit.start, fit.nuisances)


def _akin(linear: LinearisedModel, fit: Fit) -> list[int]:
    """Return the nuisances whose slopes point where those of the unknowns do, the nearest first."""
    if not fit.unknowns:
        return []
    unknowns = linear.whiten(fit.jacobian)
    unknowns = unknowns / np.maximum(np.linalg.norm(unknowns, axis=0), TINY)
    size = np.linalg.norm(linear.jacobian, axis=0)
    cosine = np.max(np.abs(unknowns.T @ linear.jacobian), axis=0) / np.maximum(size, TINY)
    order = np.argsort(-cosine)[: MOST_AKIN * len(fit.causes)]
    return [int(i) for i in order if cosine[i] > AKIN and size[i] > TELLS and linear.nuisances[i].is_simulated]
