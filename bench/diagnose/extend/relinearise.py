"""A fit again, with derivatives of the nuisances as they are about it."""

import numpy as np

from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.objective import TELLS, Objective
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.linearised_model import LinearisedModel, relinearised
from bench.errors import NOT_SIMULATED

MOST_AKIN = 5  # effort: nuisances for each cause whose derivatives are taken anew
AKIN = 0.3  # effort: correlation of what is known of them


def relinearised_fit(linear: LinearisedModel, fit: Fit) -> tuple[LinearisedModel, Fit]:
    """Return a fit again, with new derivatives of the nuisances that its causes trade with; and the design with them.

    Where friction has become half as large again, so has what its uncertainty does. Derivatives of the causes are taken
    anew over half of their standard errors. Where that finds no balance, the fit stays as it is.
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
    return about, refit(about, fit.causes, fit.start, fit.nuisances, errors=fit.sigma)


def _akin(linear: LinearisedModel, fit: Fit) -> list[int]:
    """Return the nuisances that the unknowns trade with, the most correlated first.

    The friction that a side had before some of it moved acts as little like what moved as all friction does, and
    together with the other side's it acts as that alone.
    """
    if not fit.unknowns:
        return []
    p, size = len(linear.nuisances), np.linalg.norm(linear.jacobian, axis=0)
    tangent = np.concatenate([linear.jacobian, linear.whiten(fit.jacobian)], axis=1)
    units = np.concatenate([np.ones(p), [unknown.sigma for unknown in fit.unknowns]])
    covariance = np.linalg.inv(tangent.T @ tangent + np.diag(1 / units**2))
    deviation = np.sqrt(np.diag(covariance))
    correlation = np.max(np.abs(covariance[p:, :p] / np.outer(deviation[p:], deviation[:p])), axis=0)
    order = np.argsort(-correlation)[: MOST_AKIN * len(fit.causes)]
    return [int(i) for i in order if correlation[i] > AKIN and size[i] > TELLS and linear.nuisances[i].is_simulated]
