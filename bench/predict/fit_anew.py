"""The fit of what may be anew in a recording, and of nothing else.

What is another one in each recording anyway (zeros and gains of drives, viscous friction, a tracker that is set up
anew; `bench/effects/drifts.py`) may be fitted beside it, within what that table allows, and is taken out of the result
again: else an offset that holds up a load would be a payload, with an interval that knows nothing of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnose.cross_validation.figures import FittedFigure, fitted_figures
from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.refit import refit, refitted
from bench.diagnose.linearise.lack_of_fit import are_settled, factors_of
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.other_noise import raised
from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.world import World
from bench.effects.drifts import COULOMB, DAY_K
from bench.predict.free import COULOMB_FIGURES, freed_causes, freed_figures
from bench.predict.model_errors import ModelErrors
from bench.record.campaign import Array

ROUNDS = 6  # effort: as in a diagnosis


@dataclass(frozen=True, eq=False)
class Anew:
    """A recording with what is free in it fitted, and everything else as the model has it.

    Attributes:
        linear: The recording, with standard errors that count what is left.
        fit: Of what is free, and of what is another one in each recording.
        world: What is free, as fitted.
        residual: Shape (T, c), measured less simulated with it; nan where not measured.
        freed: Names of the figures that are free.
    """

    linear: LinearisedModel
    fit: Fit
    world: World
    residual: Array
    freed: frozenset[str]

    def figures(self, errors: ModelErrors | None = None) -> tuple[tuple[FittedFigure, FittedFigure | None], ...]:
        """Return what is free, with intervals that know of what is another one in each recording.

        Args:
            errors: Of the model; None: it is taken as exact.

        Returns:
            Each once with the interval of its difference from what the recordings of the model had, and once with that
            of its difference from the model as it stands, if errors are given.
        """
        if errors is None:
            rows = [(one, None) for one in fitted_figures(self.linear, self.fit)]
        else:
            beside = errors.variances(self.linear, self.fit, self.freed)
            rows = list(zip(*(fitted_figures(self.linear, self.fit, one) for one in beside), strict=True))
        return tuple((one, other) for one, other in rows if one.kind == "finding" or one.name in self.freed)


def freed_beside_the_day(linear: LinearisedModel, free: Sequence[str]) -> Anew:
    """Fit what is free beside what is another one in each recording, and take that out again.

    Args:
        linear: The recording, linearised about the model, with all its figures.
        free: Names, from `FREE`.

    Raises:
        InputError, ConvergenceError, RobotError: As `fit_anew`.
    """
    alone = _with_figures(linear, free)
    freed = frozenset(map(str, alone.nuisances))
    linear, fit = _settled(_with_the_day(linear, alone), free)
    is_freed = np.array([str(one) in freed for one in linear.nuisances], dtype=bool)
    world = replace(fit, nuisances=np.where(is_freed, fit.nuisances, 0.0)).world(linear)
    return Anew(linear, fit, world, linear.observed - linear.replay.predict(world), freed)


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
    return _settled(_with_figures(linear, free), free)


def _settled(linear: LinearisedModel, free: Sequence[str]) -> tuple[LinearisedModel, Fit]:
    """Return a recording with standard errors that count what its model leaves, and the fit of its figures."""
    fit = refit(linear, freed_causes(free, linear.replay.compiled), {})
    for _ in range(ROUNDS):
        factors = factors_of(linear, linear.whiten(fit.residual), 1.0, is_last=True)
        if are_settled(factors):
            break
        linear = raised(linear, factors)
        fit = refitted(linear, fit)
    return linear, fit


def fitted_as(linear: LinearisedModel, free: Sequence[str], inflation: Array) -> tuple[LinearisedModel, Fit]:
    """Fit what is free as `fit_anew`, with the standard errors of another fit.

    Args:
        linear: As of `fit_anew`.
        free: As of `fit_anew`; may be none.
        inflation: Shape (2, c), of the standard errors.

    Returns:
        As `fit_anew`.

    Raises:
        InputError, ConvergenceError, RobotError: As `fit_anew`.
    """
    linear = raised(_with_figures(linear, free), inflation / linear.inflation)
    return linear, refit(linear, freed_causes(free, linear.replay.compiled), {})


def _with_figures(linear: LinearisedModel, free: Sequence[str]) -> LinearisedModel:
    """Return a recording of which no figures are uncertain but those that are free."""
    which = freed_figures(free, linear.nuisances)
    return replace(
        linear,
        nuisances=tuple(linear.nuisances[i] for i in which),
        sensitivities=linear.sensitivities[:, :, which],
        jacobian=linear.jacobian[:, which],
    )


def _with_the_day(linear: LinearisedModel, alone: LinearisedModel) -> LinearisedModel:
    """Return a recording of freed figures with what is another one in each recording beside them.

    The model has the own part of a recording that it was fitted to, and this one has another: of the difference the
    variance is twice as large.
    """
    names = {str(one) for one in alone.nuisances}
    which = [i for i, one in enumerate(linear.nuisances) if _own(one) and str(one) not in names]
    day = [replace(linear.nuisances[i], sigma=float(np.sqrt(2)) * _own(linear.nuisances[i])) for i in which]
    scale = np.array([one.sigma / linear.nuisances[i].sigma for one, i in zip(day, which, strict=True)])
    return replace(
        alone,
        nuisances=(*alone.nuisances, *day),
        sensitivities=np.concatenate([alone.sensitivities, linear.sensitivities[:, :, which] * scale], axis=2),
        jacobian=np.concatenate([alone.jacobian, linear.jacobian[:, which] * scale], axis=1),
    )


def _own(nuisance: Nuisance) -> float:
    """Return the standard deviation of what of a figure is another one in each recording, in its unit."""
    return COULOMB * DAY_K if nuisance.name.startswith(COULOMB_FIGURES) else nuisance.own
