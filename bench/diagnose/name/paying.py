"""What pays: each finding of a model held against what was held out, beside all others."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bench.diagnose.cross_validation.held_out import HeldOut, held_out
from bench.diagnose.cross_validation.jackknife import with_jackknife
from bench.diagnose.cross_validation.leave_out import Tangent, tangent_of
from bench.diagnose.extend.fit import Fit, fit_without
from bench.diagnose.extend.refit import refit, refitted
from bench.diagnose.extend.size import evidence_of, is_clear_of_none, wald
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.threshold import LEAST
from bench.diagnose.name.models import Model
from bench.diagnose.name.naming import Finding
from bench.diagnose.name.simulation_error import SimulationError, imitated, rise_of
from bench.errors import NOT_SIMULATED
from bench.executor.contract import Executor, Progress, in_order
from bench.executor.serial import SERIAL

# effort: evidence that is lost without a finding, from where no better fit without it brings it back: derivatives about
# itself gave one 41 at most (recording A of the KR300), and an arm without friction takes a minute for them
DECIDED = 200.0
# effort: the same by derivatives alone, from where a fit without it does not take them anew: of an arm without friction
# that was two thirds of a diagnosis
PLAIN = 10 * DECIDED


def held_findings(
    linear: LinearisedModel,
    null: Fit,
    model: Model,
    causes: Sequence[Cause],
    threshold: float,
    executor: Executor = SERIAL,
) -> dict[Hashable, Finding]:
    """Return what causes of a model are worth beside the others, if there is a balance without them.

    Args:
        linear: The campaign about the model.
        null: Fit of the nominal model.
        model: With the causes.
        causes: Of which to tell.
        threshold: Log evidence that chance exceeds at the declared rate.
        executor: Where to fit.
    """
    held = in_order(executor, _Held(linear, null, model, threshold), causes)
    return {
        cause.key: Finding(
            cause=cause,
            fit=model.fit,
            without=one.without.with_causes(_others(model, cause)) if one.without else None,
            log_evidence=one.rise,
            held_out=one.gain,
            is_taken=one.without is None,
        )
        for cause, one in zip(causes, held, strict=True)
        if one
    }


@dataclass(frozen=True, eq=False)
class _Worth:
    """What a cause of a model is worth beside the others, as it passes between processes.

    Attributes:
        rise: By how much the logarithm of the evidence falls without it.
        gain: What it is worth on what was held out.
        without: The model fitted without it, without the objects of its causes, where it does not pay; None: it does.
    """

    rise: float
    gain: HeldOut
    without: Fit | None


@dataclass(frozen=True, eq=False)
class _Held:
    """A model of which each cause is held against what was held out; what all causes share is worked out once.

    Attributes:
        linear, null, model, threshold: As of `held_findings`.
    """

    linear: LinearisedModel
    null: Fit
    model: Model
    threshold: float

    def __call__(self, cause: Cause, progress: Progress) -> _Worth | None:
        """Return what a cause is worth; None: there is no balance without it."""
        fit = self.model.fit
        without = _fit_without(self.design, self.model, cause, progress)
        if without is None:
            return None
        gain = held_out(self.design, without, fit, tangent=self._tangent)
        is_clear = is_clear_of_none(cause, self._as_stated)  # else runs disagree whether there is anything
        pays = gain.is_gain and is_clear and self._error.is_needed(without, self.threshold)
        return _Worth(rise_of(fit, without), gain, None if pays else without.with_causes(()))

    @cached_property
    def design(self) -> LinearisedModel:
        """The campaign with the background errors of the model."""
        return self.model.linear(self.linear)

    @cached_property
    def _tangent(self) -> Tangent:
        return tangent_of(self.design, self.model.fit)

    @cached_property
    def _as_stated(self) -> Fit:
        return with_jackknife_errors(self.model, self.linear).fit

    @cached_property
    def _error(self) -> SimulationError:
        return SimulationError(self.linear, self.null, self.model)


def shape_pays(linear: LinearisedModel, null: Fit, model: Model, threshold: float) -> bool:
    """Whether what a model has that is not listed predicts what was held out better, beside the causes.

    Args:
        linear: The campaign about the model.
        null: Fit of the nominal model.
        model: With a free shape.
        threshold: Log evidence that chance exceeds at the declared rate.
    """
    fit = model.fit
    try:
        without = fit_without_shape(linear, model)
    except NOT_SIMULATED:  # it is needed for there to be a balance at all
        return True
    if fit.log_evidence - without.log_evidence < threshold + LEAST + imitated(linear, null, fit, without):
        return False
    return held_out(model.linear(linear), without, fit, linear).is_gain


def _fit_without(design: LinearisedModel, model: Model, cause: Cause, progress: Progress) -> Fit | None:
    """Return a model fitted without one of its causes, to its end where that may matter; None: nothing balances.

    Where far more is missing than anything can make up for, a fit bends all else by hundreds of standard deviations,
    and ends anywhere: without the friction of one joint, the other two of an arm erred by fifty times as much. Then the
    fit is that of derivatives about the whole model: they tell what it comes to, and what all else can do within reach
    of what is stated.
    """
    fit = model.fit
    start = {key: value for key, value in fit.start.items() if key[:2] != cause.key}

    def refit_without(*, renews: bool) -> Fit:
        without = _others(model, cause), start, fit.nuisances, fit
        return refit(design, *without, settles=False, renews=renews, progress=progress)

    try:
        is_plain = wald(cause, fit)[0] / 2 > PLAIN
        without = refit_without(renews=not is_plain)
        lost = evidence_of(cause, fit) if is_plain else np.inf
        if np.isfinite(lost) and fit.log_evidence - without.log_evidence > DECIDED:
            return replace(fit_without(design, fit, cause), log_evidence=fit.log_evidence - lost, is_settled=False)
        if is_plain and fit.log_evidence - without.log_evidence <= DECIDED:
            without = refit_without(renews=True)
        if not without.is_settled and fit.log_evidence - without.log_evidence <= DECIDED:
            without = refitted(design, without, progress)
    except NOT_SIMULATED:
        return None
    return without


def _others(model: Model, cause: Cause) -> tuple[Cause, ...]:
    return tuple(other for other in model.causes if other.key != cause.key)


def fit_without_shape(linear: LinearisedModel, model: Model) -> Fit:
    """Return a model fitted without what is not listed."""
    fit = model.fit
    return refit(linear, fit.causes, fit.start, fit.nuisances[: len(linear.nuisances)])


def with_jackknife_errors(model: Model, linear: LinearisedModel) -> Model:
    """Return a model with standard errors that count how much runs disagree on its sizes."""
    return replace(model, fit=with_jackknife(model.linear(linear), model.fit))
