"""What the lab knows besides, held against what all other readings say of it.

A reading that the lab lists is believed as it stands: where the others contradict it, a diagnosis has to explain both,
and names causes for what may be a slip of the pen, such as the stiffness of the next joint. The nominal model with its
figures free is fitted to all other readings, with a prior so wide that it says nothing of what moves the thing known;
what they make of it then is r' with the variance s' C s, and

    z = |r - r'| / sqrt(sigma^2 + s' C s)

counts how many standard errors both are apart. Where no other reading tells the thing, C is as wide as the prior. What
no figure moves, such as the temperature of the gas, is held against the model with what was found instead.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.known import KINDS
from bench.record.campaign import Array
from bench.record.known import CONTRADICTS

FLAT = 1e3  # rounding: times its prior; what other readings tell at all is told by them alone


@dataclass(frozen=True)
class ContradictedReading:
    """Something known besides, of which the other readings say something else.

    Attributes:
        channel: Name of the quantity, such as `known_stiffness_1_nm-per-rad`.
        unit: Of the numbers below.
        value, sigma: As the lab states it.
        by_others: What the other readings make of it, with the nominal model and its figures free; of what no figure
            moves, what the model has with what was found.
        by_others_sigma: Its standard error; 0 of what no figure moves.
        apart: Standard errors of the difference.
    """

    channel: str
    unit: str
    value: float
    sigma: float
    by_others: float
    by_others_sigma: float
    apart: float


def contradicted_readings(linear: LinearisedModel, left: Array) -> Iterator[ContradictedReading]:
    """Yield each thing known besides that is more than `CONTRADICTS` standard errors from what all else says of it.

    Args:
        linear: Of the nominal model.
        left: Shape (T, c), measured less what the model has with what was found.
    """
    sigma = np.concatenate([segment.sigma for segment in linear.segments])
    for c, quantity in enumerate(linear.quantities):
        if quantity.kind not in KINDS.values():
            continue
        instants = np.flatnonzero(np.isfinite(linear.residual[:, c]))
        slopes = linear.sensitivities[instants, c]
        others = linear.column_of != c
        jacobian, white = linear.jacobian[others], linear.white[others]
        prior = np.where(np.any(slopes != 0, axis=0), FLAT**-2, 1.0)
        normal = jacobian.T @ jacobian + np.diag(prior)
        fitted = np.linalg.solve(normal, jacobian.T @ white)
        variance = np.einsum("ti,it->t", slopes, np.linalg.solve(normal, slopes.T))
        by_figures = linear.residual[instants, c] - slopes @ fitted
        beside = np.where(np.any(slopes != 0, axis=1), by_figures, left[instants, c])
        for t, difference, of_others in zip(instants, beside, np.sqrt(variance), strict=True):
            value, own = float(linear.observed[t, c]), float(sigma[t, c])
            apart = float(abs(difference) / np.hypot(own, of_others))
            if apart > CONTRADICTS:
                numbers = (value, own, float(value - difference), float(of_others), apart)
                yield ContradictedReading(quantity.column, quantity.unit, *numbers)
