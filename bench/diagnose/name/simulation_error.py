"""What a finding is worth beside others that are not simulated exactly."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.lack_of_fit import as_simulated
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.other_noise import raised
from bench.diagnose.name.models import Model, reweighed
from bench.diagnose.name.sizes import log_of_priors
from bench.errors import NOT_SIMULATED

# assumed: share of what an effect changes, to which it is simulated: bins, time steps and how friction starts to slide;
# signatures miss 0.5 to 3.5 % of simulations (tests/diagnose/test_first_order.py)
SIMULATED = 0.02
TINY = 1e-300  # rounding: for what changes nothing, so that nothing is divided by zero


def rise_of(fit: Fit, without: Fit) -> float:
    """Return by how much the logarithm of the evidence falls from one fit to another."""
    return fit.log_evidence - without.log_evidence + log_of_priors(fit) - log_of_priors(without)


def imitated(linear: LinearisedModel, null: Fit, best: Fit, without: Fit) -> float:
    """Return the most evidence for a finding that an error of `SIMULATED` in all others could imitate.

    It is counted in the channels that the finding changes: who simulates a delay of encoders wrong has not simulated a
    torque wrong. Evidence goes with the square of what is explained: an error of a share e leaves e^2.

    Args:
        linear: The campaign.
        null: Nominal model.
        best: Model with the finding.
        without: The same fitted without it.
    """
    columns, count = linear.column_of, len(linear.quantities)
    own, every = (
        np.bincount(columns, linear.whiten(fit.residual - best.residual) ** 2, count) for fit in (without, null)
    )
    touched = float(own @ every) / max(float(own.sum()), TINY)
    return 0.5 * SIMULATED**2 * touched


@dataclass(frozen=True)
class SimulationError:
    """What findings of a model are worth beside each other, where each is simulated wrong by a share `SIMULATED`.

    Attributes:
        linear: The campaign.
        null: Nominal model.
        best: Model with the findings.
    """

    linear: LinearisedModel
    null: Fit
    best: Model

    def is_needed(self, without: Fit, threshold: float) -> bool:
        """Return whether evidence for a finding is more than chance, and than what the others are simulated wrong by.

        Where it is less than the most that such errors could imitate, they are taken for noise, and it is weighed anew.

        Args:
            without: The model fitted without the finding.
            threshold: Log evidence that chance exceeds at the declared rate.
        """
        rise = rise_of(self.best.fit, without)
        if rise <= threshold or rise > threshold + imitated(self.linear, self.null, self.best.fit, without):
            return rise > threshold
        try:
            other = reweighed(replace(self.best, fit=without), self.linear, self._noisy)
            return rise_of(self._with_noise.fit, other.fit) > threshold
        except NOT_SIMULATED:
            return False

    @cached_property
    def _noisy(self) -> LinearisedModel:
        left = self.linear.whiten(self.best.fit.residual)
        explained = self.linear.whiten(self.null.residual) - left
        return raised(self.linear, as_simulated(self.linear, explained, left, SIMULATED))

    @cached_property
    def _with_noise(self) -> Model:
        return reweighed(self.best, self.linear, self._noisy)
