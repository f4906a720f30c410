"""What tests put a diagnosis together from: a made-up effect, the fit of one cause, a small linearised model."""

from collections.abc import Sequence

import numpy as np

from bench.diagnose.extend.fit import Fit, unknowns_of
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.marginal import Nuisances
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.effects.effect import Effect, Parameter
from bench.record.campaign import Array, Campaign
from tests.diagnose.sweeps import nominal

X = Parameter("x", "m", 0.0, 1e-3, 1e-2, "shift along x", signed=True)
Z = Parameter("z", "m", 0.0, 1e-3, 1e-2, "shift along z", signed=True)
WAVE = Parameter("period", "rad", 0.5, 0.1, 2.0, "of the shift", is_shape=True, ratio=2.0)


class Shift(Effect):
    """Something that moves along two axes."""

    name = "shift"
    family = "own"
    title = "shift"
    physics = "It moves."
    source = "made up"
    parameters = (X, Z, WAVE)


def fit_alone(cause: Cause, values: Sequence[float], covariance: Array) -> Fit:
    """Return a fit of one cause with values, shape (p,), and a covariance, shape (p, p), without readings."""
    unknowns, zero = unknowns_of((cause,)), np.zeros((1, 1))
    left = (zero, zero[:, :, None], np.zeros(1))
    return Fit((cause,), unknowns, np.array(values), covariance, np.zeros(0), 0.0, 0.0, *left)


def chi_square_left(linear: LinearisedModel, white: Array, without: str = "nothing") -> float:
    """Return the chi-square of whitened readings, shape (m,), that nuisances leave, their priors counted.

    Args:
        linear: The campaign.
        white: What is to be explained.
        without: Nuisances that have this in their names do not act.
    """
    kept = np.array([without not in one.name for one in linear.nuisances])
    jacobian = linear.jacobian[:, kept]
    return float(white @ (white - jacobian @ Nuisances(jacobian).most_probable(white)))


def linear_of(campaign: Campaign) -> LinearisedModel:
    """Return the linearised model of a campaign of the nominal robot, with the first two nuisances alone."""
    compiled = nominal()
    quantities = quantities_of(campaign.runs, compiled)
    replay = Replay(compiled, segments_of(campaign, compiled, quantities), quantities)
    return linearised_model_of(replay, nuisances_of(compiled, quantities)[:2])
