"""The fit of what may be anew in a recording, and of nothing else."""

from collections.abc import Sequence
from dataclasses import replace

from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.refit import refit, refitted
from bench.diagnose.linearise.lack_of_fit import are_settled, factors_of
from bench.diagnose.linearise.linearised_model import LinearisedModel, raised
from bench.predict.free import freed_causes, freed_figures
from bench.record.campaign import Array

ROUNDS = 6  # as in a diagnosis


def fit_anew(linear: LinearisedModel, free: Sequence[str]) -> tuple[LinearisedModel, Fit]:
    """Fit what is free by simulation, under its stated prior; everything else stays as the model has it.

    What the model misses even so counts as noise, neighbours that err alike once: intervals of a model that leaves much
    are wide.

    Args:
        linear: The recording, linearised about the model.
        free: Names, from `FREE`.

    Returns:
        The recording with the freed figures alone, and the fit.

    Raises:
        InputError: The recording shows nothing of what is free, or the robot has no such part.
        ConvergenceError, RobotError: As `refit`.
    """
    linear = _with_figures(linear, free)
    fit = refit(linear, freed_causes(free, linear.replay.compiled), {})
    for _ in range(ROUNDS):
        factors = factors_of(linear, linear.whiten(fit.residual), 1.0, is_last=True)
        if are_settled(factors):
            break
        linear = raised(linear, factors)
        fit = refitted(linear, fit)
    return linear, fit


def fitted_as(linear: LinearisedModel, free: Sequence[str], inflation: Array) -> Fit:
    """Fit what is free as `fit_anew`, with the standard errors of another fit.

    Args:
        linear: As of `fit_anew`.
        free: As of `fit_anew`; may be none.
        inflation: Shape (2, c), of the standard errors.

    Raises:
        InputError, ConvergenceError, RobotError: As `fit_anew`.
    """
    linear = raised(_with_figures(linear, free), inflation / linear.inflation)
    return refit(linear, freed_causes(free, linear.replay.compiled), {})


def _with_figures(linear: LinearisedModel, free: Sequence[str]) -> LinearisedModel:
    """Return a recording of which no figures are uncertain but those that are free."""
    which = freed_figures(free, linear.nuisances)
    return replace(
        linear,
        nuisances=tuple(linear.nuisances[i] for i in which),
        sensitivities=linear.sensitivities[:, :, which],
        jacobian=linear.jacobian[:, which],
    )
