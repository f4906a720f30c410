"""Whether data tell a size by itself, or its prior comes back as if it had been found."""

import numpy as np

from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.candidates import Cause
from bench.identify.told import is_told as is_told  # one rule, for those who compare too
from bench.record.campaign import Array

# rounding: of the precision of a prior; information on a combination of sizes that is less than that is none
UNTOLD = 1e-9


def told_sizes(cause: Cause, fit: Fit) -> dict[str, bool]:
    """Return, for each size of a cause, whether the data of a fit tell it (`identify/told.py`).

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
    posterior = alone / (1 + alone)
    return {fit.unknowns[i].parameter.name: is_told(float(v), 1.0) for i, v in zip(mine, posterior, strict=True)}
