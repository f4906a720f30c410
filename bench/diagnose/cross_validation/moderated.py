"""How far runs differ, of each channel, where a few runs hardly say: each variance is held against those of all others.

Variances of channels scatter about a common one as d0 s0^2 / chi^2(d0); both come from the channels themselves, by the
moments of their logarithms. The variance of one channel with d degrees of freedom then is

    (d0 s0^2 + d s^2) / (d0 + d),   with d0 + d degrees of freedom

(Smyth, Linear models and empirical Bayes methods for assessing differential expression, Statistical Applications in
Genetics and Molecular Biology 3, 2004), and no more than all channels have together. With channels that differ a lot
d0 is small, and each stands for itself.
"""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import brentq
from scipy.special import digamma, polygamma

from bench.record.campaign import Array

SMALLEST = 1e-5  # rounding: of the median variance; a channel that happens to be equal in two runs has a logarithm
FEWEST, MOST = 1e-2, 1e4  # rounding: degrees of freedom between which they are looked for: as good as none, and as all


def moderated(rms: Sequence[Array]) -> tuple[tuple[float, float], ...]:
    """Return a standard deviation of the logarithm, and its degrees of freedom, for each channel.

    Both are nan where neither the channel nor any other was seen in two runs.

    Args:
        rms: Root mean squares in runs, shape (K,) for each channel.
    """
    degrees = np.array([len(one) - 1 if np.all(one > 0) else 0 for one in rms], dtype=np.float64)
    variance = np.array([np.log(one).var(ddof=1) if d else 0.0 for one, d in zip(rms, degrees, strict=True)])
    there = degrees > 0
    if not np.any(there):
        return ((np.nan, np.nan),) * len(rms)
    common, weight = _common(variance[there], degrees[there])
    found = []
    for s, d in zip(variance.tolist(), degrees.tolist(), strict=True):
        if np.isinf(weight):
            found.append((float(np.sqrt(common)), float(degrees.sum())))
        elif weight + d > 0:
            found.append(
                (float(np.sqrt((weight * common + d * s) / (weight + d))), min(weight + d, float(degrees.sum())))
            )
        else:
            found.append((np.nan, np.nan))
    return tuple(found)


def _common(variance: Array, degrees: Array) -> tuple[float, float]:
    """Return the common variance and how many degrees of freedom it counts for; of one channel alone none."""
    if len(variance) < 2:
        return 0.0, 0.0
    logs = np.log(np.maximum(variance, SMALLEST * np.median(variance)))
    half = degrees / 2
    shifted = logs - digamma(half) + np.log(half)
    excess = float(np.var(shifted, ddof=1) - np.mean(polygamma(1, half)))
    least, most = float(polygamma(1, MOST / 2)), float(polygamma(1, FEWEST / 2))
    if excess <= least:
        return float(np.exp(shifted.mean())), np.inf
    prior = (
        FEWEST / 2 if excess >= most else float(brentq(lambda x: float(polygamma(1, x)) - excess, FEWEST / 2, MOST / 2))
    )
    return float(np.exp(shifted.mean() + digamma(prior) - np.log(prior))), 2 * prior
