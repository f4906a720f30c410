"""Whether data say anything of a size by itself, or its prior comes back as if it had been found."""

import numpy as np

from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.candidates import Cause
from bench.record.campaign import Array

LEAST_TOLD = 0.01  # rounding: of a prior's standard deviation, by which data have to narrow it, to say anything
# rounding: of the precision of a prior; information on a combination of sizes that is less than that is none
UNTOLD = 1e-9


def is_narrower(sigma: float, prior: float) -> bool:
    """Whether a standard deviation is so much smaller than that of the prior that data say something."""
    return not sigma > (1 - LEAST_TOLD) * prior  # the prior is nan where there is none


def told_sizes(cause: Cause, fit: Fit) -> dict[str, bool]:
    """Return, for each size of a cause, whether the data of a fit say anything of it.

    Of sizes that act alike the data know a sum, and the priors of the others would narrow each of them: of the second
    moments of a payload that turns about one axis, S_x + S_y. What counts is what the data say of a size with nothing
    known of the others. In standard deviations of the priors the posterior has the covariance C = (H + I)^-1, H the
    information of the data; with C = V diag(c) V^T, the data by themselves leave H^-1 = V diag(c / (1 - c)) V^T.
    """
    mine = fit.where(cause)
    prior = np.array([fit.unknowns[i].sigma for i in mine])
    values, directions = np.linalg.eigh(fit.covariance[np.ix_(mine, mine)] / np.outer(prior, prior))
    share = np.clip(values, 0.0, 1 / (1 + UNTOLD))
    alone: Array = directions**2 @ (share / (1 - share))
    posterior = np.sqrt(alone / (1 + alone))
    return {
        fit.unknowns[i].parameter.name: is_narrower(float(sigma), 1.0) for i, sigma in zip(mine, posterior, strict=True)
    }
