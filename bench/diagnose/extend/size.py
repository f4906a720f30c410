"""How large and how sure a cause is, as fitted: against what is plausible, and against its standard error."""

from dataclasses import dataclass

from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.candidates import Cause

NORMAL_95 = 1.959964  # exact: standard errors on either side of a 95 % interval of a normal distribution


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
    for unknown, value, sigma in zip(fit.unknowns, fit.values, fit.sigma, strict=True):
        if unknown.cause is cause and not unknown.parameter.is_shape:
            off = abs(float(value) - unknown.parameter.null)
            sizes.append(Size(off / unknown.parameter.high, off / float(sigma) if sigma > 0 else float("inf")))
    clear = [size for size in sizes if size.sigmas > NORMAL_95]
    if clear:
        return max(clear, key=lambda size: size.share)
    return sizes[0] if sizes else Size(float("nan"), float("nan"))
