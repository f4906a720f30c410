"""What is known of the sizes of causes beside the normal priors of a fit: their signs, and how wide a prior may be."""

import numpy as np
from scipy.special import logsumexp

from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.marginal import log_evidences_of, log_half_normal
from bench.diagnose.linearise.screening import widths_of
from bench.record.campaign import Array

TINY = 1e-300  # rounding: so that nothing is divided by zero


def log_of_priors(fit: Fit) -> float:
    """Return what is known of sizes beside their normal priors, as what it adds to the logarithm of the evidence."""
    return log_of_signs(fit) + sum(float(logsumexp(log_of_widths(fit, cause))) for cause in fit.causes)


def log_of_signs(fit: Fit) -> float:
    """Return what sizes that have one sign only add to the logarithm of the evidence, which normal priors gave."""
    sizes = [i for i, one in enumerate(fit.unknowns) if not one.parameter.is_shape and not one.parameter.signed]
    return float(np.sum(log_half_normal(fit.off[sizes], np.maximum(fit.sigma[sizes], TINY), np.ones(len(sizes)))))


def log_of_widths(fit: Fit, cause: Cause) -> Array:
    """Return what each width that the prior of a cause may have adds to the log evidence, with its share of the odds.

    Exact where readings are linear in the sizes: with the covariance C and the mean m that a prior P^2 gave, data say
    H = C^-1 - P^-2 and b = C^-1 m, and log E(w) = b' (H + (w P)^-2)^-1 b / 2 - log det(1 + (w P) H (w P)) / 2.
    """
    mine = fit.where(cause)
    prior = np.array([fit.unknowns[i].sigma for i in mine])
    mean = fit.off[mine] / prior
    said = np.linalg.inv(fit.covariance[np.ix_(mine, mine)] / np.outer(prior, prior))
    information, pull = said - np.eye(len(mine)), said @ mean
    widths = np.outer(widths_of(cause), np.ones(len(mine)))
    every = np.stack([np.diag(width**-2) for width in widths])
    found = log_evidences_of(information + every, np.tile(pull, (len(widths), 1)), widths)
    added: Array = found - found[0] - np.log(len(widths))
    return added
