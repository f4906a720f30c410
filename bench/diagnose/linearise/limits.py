"""How large an effect must be to be found in a campaign: from the instruments, what may be off, and the threshold."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.diagnose.linearise.candidates import Candidate, Cause, shape_grid
from bench.diagnose.linearise.screening import Screening
from bench.effects.effect import Parameter
from bench.record.campaign import Array


@dataclass(frozen=True)
class DetectionLimit:
    """The smallest size of a cause that this campaign would have shown.

    Attributes:
        effect: Of the catalogue.
        place: Where it would act.
        parameter: Its size.
        limit: Smallest size that would have been found, in `unit`; of several shapes, that of the one seen best.
        unit: SI; "" for a relative size.
        worst: The same for the shape seen worst; inf where the data say nothing of one of the shapes.
        plausible: Largest plausible size.
        shapes: How many were tried; 1 for a cause that has no shape parameter.
    """

    effect: str
    place: str
    parameter: str
    limit: float
    unit: str
    worst: float
    plausible: float
    shapes: int

    @property
    def is_plausible(self) -> bool:
        """Whether a plausible size would have been found, whatever the shape."""
        return self.worst <= self.plausible


def smallest_found(information: float, prior: float, threshold: float) -> float:
    """Return the smallest size whose expected evidence reaches a threshold; inf where the data say nothing of it.

    With the information I on a size, nuisances integrated out, and its prior p, noise-free data of size s give a log
    evidence of s^2 I w / 2 - log(1 + p^2 I) / 2 with w = p^2 I / (1 + p^2 I).
    """
    known = prior**2 * information
    if known <= 0:
        return float("inf")
    return float(np.sqrt((2 * threshold + np.log1p(known)) * (1 + known) / known / information))


def detection_limits(screening: Screening, information: Array | None = None) -> tuple[DetectionLimit, ...]:
    """Return the limits of everything that was tried, over all shapes of each cause.

    Args:
        screening: Of everything.
        information: Shape (q,), on the size of each column; None: that of the data, nuisances integrated out.
    """
    sizes = {
        (*entry.cause.key, size.name): (entry.cause, size)
        for entry in screening.entries
        if entry.cause
        for size in entry.cause.sizes
    }
    found = {key: [limit for _, limit in limits] for key, limits in _limits_of_shapes(screening, information).items()}
    return tuple(_over_shapes(key, limits, *sizes[key]) for key, limits in found.items() if np.isfinite(np.min(limits)))


def least_shape_seen(screening: Screening, cause: Cause) -> float:
    """Return the least value of the shape parameter of a cause that has one at which a plausible size would be found.

    inf where it would at none, and the least that is plausible where it would at all.
    """
    (shape,), size = cause.shapes, cause.sizes[0]
    limits = _limits_of_shapes(screening).get((*cause.key, size.name), [])
    return min((values[shape.name] for values, limit in limits if limit <= size.high), default=float("inf"))


def _limits_of_shapes(
    screening: Screening, information: Array | None = None
) -> dict[tuple[str, str, str], list[tuple[Mapping[str, float], float]]]:
    """Return effect, place and size of everything that was tried -> each of its shapes with the limit for that."""
    known = screening.marginal.diagonal if information is None else information
    found: dict[tuple[str, str, str], list[tuple[Mapping[str, float], float]]] = {}
    for entry in screening.entries:
        what = entry.what
        if not isinstance(what, Candidate):
            continue
        for i, (size, column, step) in enumerate(zip(what.cause.sizes, entry.columns, what.step, strict=True)):
            smallest = (
                smallest_found(float(known[column]), float(prior[i]), screening.threshold - share)
                for prior, share in entry.priors
            )
            limit = min(smallest) * abs(float(step))
            found.setdefault((*what.cause.key, size.name), []).append((what.shape, limit))
    return found


def _over_shapes(key: tuple[str, str, str], limits: list[float], cause: Cause, size: Parameter) -> DetectionLimit:
    """Return the limit of one size of a cause from those of its shapes; one that leaves no trace was not tried."""
    shapes = len(shape_grid(cause))
    worst = max(limits) if len(limits) == shapes else float("inf")
    return DetectionLimit(*key, min(limits), size.unit, worst, size.high, shapes)
