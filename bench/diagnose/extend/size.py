"""How large and how sure a cause is, as fitted: against what is plausible, and against its standard error."""

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtri

from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.candidates import Cause

NORMAL_95 = 1.959964  # exact: standard errors on either side of a 95 % interval of a normal distribution
CLEAR = 0.95  # declared: level of the intervals that are stated


@dataclass(frozen=True)
class Size:
    """The size of a cause.

    Attributes:
        share: Its distance from none against the largest plausible one; nan where the fit has not the cause.
        sigmas: The same in standard errors; inf where it has none.
    """

    share: float
    sigmas: float


def size_of(cause: Cause, fit: Fit) -> Size:
    """Return the size of a cause of a fit.

    A cause of several sizes (three components of a shift) is as large as the greatest share of those whose 95 %
    interval leaves out none; where there is no such size, the first counts, by which people know the effect.
    """
    sizes = []
    for i in fit.where(cause):
        off, sigma = abs(float(fit.off[i])), float(fit.sigma[i])
        plausible = fit.unknowns[i].parameter.high / cause.reach
        sizes.append(Size(off / plausible, off / sigma if sigma > 0 else float("inf")))
    clear = [size for size in sizes if size.sigmas > NORMAL_95]
    if clear:
        return max(clear, key=lambda size: size.share)
    return sizes[0] if sizes else Size(float("nan"), float("nan"))


def is_clear_of_none(cause: Cause, fit: Fit) -> bool:
    """Return whether the sizes of a cause, taken together, lie outside of the 95 % region of none.

    Of shifts and turns of a frame that trade against each other none may be clear by itself, and all of them together
    are. A free shape counts as a size, for it was chosen to make them clear.
    """
    statistic, count = wald(cause, fit)
    shapes = sum(one.cause is cause and one.parameter.is_shape for one in fit.unknowns)
    return count > 0 and bool(statistic > chdtri(count + shapes, 1 - CLEAR))


def wald(cause: Cause, fit: Fit) -> tuple[float, int]:
    """Return the Wald statistic x' C^-1 x of the sizes of a cause, all else fitted again, and how many they are.

    Half of it is the log likelihood that a fit loses without the cause, as its derivatives have it; where there is
    nothing, and its shapes are given, it is chi-square with as many degrees of freedom. It is inf where a size without
    an error is off none.
    """
    off, covariance = fit.sizes_against_none(cause)
    count, known = len(off), np.diag(covariance) > 0
    if np.any(off[~known] != 0):
        return float("inf"), count
    off, covariance = off[known], covariance[np.ix_(known, known)]
    return float(off @ np.linalg.solve(covariance, off)), len(off)


def evidence_of(cause: Cause, fit: Fit) -> float:
    """Return the log evidence that a fit loses without a cause, as its derivatives have it, all else fitted again.

    In a linear model with normal priors that is x' C^-1 x / 2 + log det C / 2 - sum log s, with sizes x of the cause,
    their covariance C, and standard deviations s of their priors (the ratio of Savage and Dickey). Shapes are held. It
    is inf where a size has no error: derivatives do not tell it then.
    """
    _, covariance = fit.sizes_against_none(cause)
    if np.any(np.diag(covariance) <= 0):
        return float("inf")
    deviations = np.array([fit.unknowns[i].sigma for i in fit.where(cause)])
    _, determinant = np.linalg.slogdet(covariance)
    return 0.5 * float(wald(cause, fit)[0] + determinant) - float(np.sum(np.log(deviations)))
