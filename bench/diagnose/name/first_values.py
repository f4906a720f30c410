"""With which sizes a fit of something that was screened begins, and between which bounds."""

import numpy as np

from bench.diagnose.extend.fit import Key, Unknown
from bench.diagnose.linearise.candidates import Candidate, Cause
from bench.diagnose.linearise.screening import Entry
from bench.record.campaign import Array


def first_bounds(what: Entry | Cause, k: int) -> Array:
    """Return the least and the largest sizes with which a fit of a term may begin, shape (2, k); inf where any may.

    Args:
        what: The term. Sizes of a cause that is in the model already are those of its fit.
        k: Number of its columns.
    """
    if isinstance(what, Cause) or not isinstance(what.what, Candidate):
        return np.stack([np.full(k, -np.inf), np.full(k, np.inf)])
    candidate = what.what
    null = np.array([size.null for size in candidate.cause.sizes])
    ends = (
        np.array([Unknown(candidate.cause, size).bounds for size in candidate.cause.sizes]).T - null
    ) / candidate.step
    return np.sort(ends, axis=0)


def first_values(candidate: Candidate, sizes: Array) -> dict[Key, float]:
    """Return first values of a candidate's parameters, from its sizes in steps."""
    key = candidate.cause.key
    values = {(*key, name): value for name, value in candidate.shape.items()}
    for size, x, step in zip(candidate.cause.sizes, sizes, candidate.step, strict=True):
        value = size.null + float(x * step)
        if candidate.cause.effect.scatters:  # where chance acts, which the linearised model does not know
            value = max(value, size.typical)
        values[*key, size.name] = value
    return values
