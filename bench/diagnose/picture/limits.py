"""How large an effect must be to be found in a campaign: from the instruments, what may be off, and the threshold."""

from dataclasses import dataclass

import numpy as np

from bench.diagnose.picture.candidates import Candidate
from bench.diagnose.picture.screening import Screening


@dataclass(frozen=True)
class DetectionLimit:
    """The smallest size of a cause that this campaign would have shown.

    Attributes:
        effect: Of the catalogue.
        place: Where it would act.
        parameter: Its size.
        limit: Smallest size that would have been found, in `unit`.
        unit: SI; "" for a relative size.
    """

    effect: str
    place: str
    parameter: str
    limit: float
    unit: str


def smallest_found(information: float, prior: float, threshold: float) -> float:
    """Return the smallest size whose expected evidence reaches a threshold; inf where the data say nothing of it.

    With the information I on a size, nuisances integrated out, and its prior p, noise-free data of size s give a log
    evidence of s^2 I w / 2 - log(1 + p^2 I) / 2 with w = p^2 I / (1 + p^2 I).
    """
    known = prior**2 * information
    if known <= 0:
        return float("inf")
    return float(np.sqrt((2 * threshold + np.log1p(known)) * (1 + known) / known / information))


def detection_limits(screening: Screening) -> tuple[DetectionLimit, ...]:
    """Return the limits of everything that was tried; for a cause of several shapes, that of the one seen best."""
    found: dict[tuple[str, str, str], DetectionLimit] = {}
    known = screening.marginal.diagonal
    for entry in screening.entries:
        what = entry.what
        if not isinstance(what, Candidate):
            continue
        prior, share = entry.priors[0]
        for size, column, sigma, step in zip(what.cause.sizes, entry.columns, prior, what.step, strict=True):
            limit = smallest_found(float(known[column]), float(sigma), screening.threshold - share) * abs(float(step))
            key = (*what.cause.key, size.name)
            if np.isfinite(limit) and (key not in found or limit < found[key].limit):
                found[key] = DetectionLimit(*what.cause.key, size.name, limit, size.unit)
    return tuple(found.values())
