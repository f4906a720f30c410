"""Models that extend the nominal one by findings, fitted by simulation: listed causes, and at most one free shape."""

from collections.abc import Hashable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf

import numpy as np

from bench.diagnose.extend.fit import Fit
from bench.diagnose.extend.refit import refitted
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.generic import Block, anew
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.name.candidate_model import CandidateModel, Fitted, fit_of, settled_of, starts_elsewhere, with_shape
from bench.diagnose.name.sizes import log_of_priors
from bench.executor.contract import Executor, in_order
from bench.record.campaign import Array

# effort: evidence that derivatives about a model may add: where they were missing about one with play, they lowered
# chi-square by 21, which is 10.5 (tests/diagnose/test_refit.py)
MOST_GAINED = 12.0


@dataclass(frozen=True, eq=False)
class Model:
    """The nominal model with findings, fitted.

    Attributes:
        fit: Of the causes; where there is a shape, in the design that has it among its nuisances (`with_shape`).
        shape: What is not listed, or None.
        log_evidence: Logarithm of its Bayes factor against the nominal model.
        log_posterior: The same with prior odds.
        probability: Among everything that was weighed.
    """

    fit: Fit
    shape: Block | None = None
    log_evidence: float = 0.0
    log_posterior: float = 0.0
    probability: float = 1.0

    @property
    def causes(self) -> tuple[Cause, ...]:
        """Its listed causes."""
        return self.fit.causes

    @property
    def keys(self) -> frozenset[Hashable]:
        """What tells it from others: its causes and its shape."""
        shape = {str(self.shape)} if self.shape else set()
        return frozenset({cause.key for cause in self.causes} | shape)

    def linear(self, plain: LinearisedModel) -> LinearisedModel:
        """Return the design that it is fitted in."""
        plain = self.fit.design(plain)
        return with_shape(plain, self.shape) if self.shape else plain

    def listed_fit(self, plain: LinearisedModel) -> Fit:
        """Return the fit without what is not listed: its part is left in the residual."""
        if self.shape is None:
            return self.fit
        p, linear = len(plain.nuisances), self.linear(plain)
        left = self.fit.residual + linear.sensitivities[:, :, p:] @ self.fit.nuisances[p:]
        return replace(self.fit, nuisances=self.fit.nuisances[:p], residual=left)

    def shape_estimate(self, plain: LinearisedModel) -> tuple[Array, Array]:
        """Return the coefficients of the shape, shape (k,), and their covariance, (k, k), everything else free.

        Where the shape is orthogonal to listed causes, these are of what it adds to them: the level that a friction has
        already is not told twice.
        """
        assert self.shape
        linear, own = self.linear(plain), slice(len(plain.nuisances), None)
        jacobian = np.concatenate([linear.whiten(self.fit.jacobian), linear.jacobian], axis=1)
        prior = np.concatenate(
            [[1 / unknown.sigma**2 for unknown in self.fit.unknowns], np.ones(linear.jacobian.shape[1])]
        )
        k = jacobian.shape[1] - self.shape.columns.shape[1]
        covariance = np.linalg.inv(jacobian.T @ jacobian + np.diag(prior))[k:, k:]
        added = np.linalg.lstsq(anew(plain, self.shape).columns, self.shape.columns * self.shape.prior)[0]
        return added @ self.fit.nuisances[own], added @ covariance @ added.T


def likeliest(models: Iterable[Model]) -> Model:
    """Return the most probable one."""
    return max(models, key=lambda model: model.log_posterior)


@dataclass(eq=False)
class Fitter:
    """Fits models to a design, and remembers them.

    Attributes:
        linear: The campaign.
        null: Fit of the nominal model to it.
        executor: Where to fit.
        known: Fit near all of them, whose derivatives will do as long as they promise what comes true; or None.
        settles: Whether fits that may decide are brought to their ends by derivatives about themselves.
        earlier: Fits of the campaign with other priors. Where `known` is none, a fit begins at that of these which has
            most causes in common with it, and with its derivatives.
        models: Keys -> model; None where it finds no balance, is not plausible, or does not need one of its causes.
        too_large: Keys of causes that a fit wanted to be larger than plausible.
    """

    linear: LinearisedModel
    null: Fit
    executor: Executor
    known: Fit | None = None
    settles: bool = True
    earlier: Sequence[Fit] = ()
    models: dict[frozenset[Hashable], Model | None] = field(default_factory=dict)
    too_large: set[Hashable] = field(default_factory=set)

    def fitted(self, candidates: Sequence[CandidateModel]) -> list[Model]:
        """Return the models of trials, each without the causes that it turned out not to need.

        Those that `models` has None for are left out.

        Raises:
            EffectError: An effect of the user's own fails.
        """
        new = list(
            {candidate.keys: candidate for candidate in candidates if candidate.keys not in self.models}.values()
        )
        fits = self._fits(new)
        done = {one.keys: (one, fitted) for one, fitted in zip(new, fits, strict=True) if fitted}
        self.models |= {one.keys: self._model(*done[one.keys]) if one.keys in done else None for one in new}
        self.too_large |= {one.causes[i].key for one, fitted in done.values() for i in fitted.too_large}
        # trials that lose what they do not need come to the same model: it is the likeliest of their fits, settled once
        every = sorted(filter(None, self.models.values()), key=lambda model: model.log_posterior)
        same: dict[frozenset[Hashable], Model | None] = {model.keys: model for model in every}
        # derivatives about a model take a simulation for each nuisance: only where they may decide
        least = max((model.fit.log_evidence for model in every), default=-np.inf) - MOST_GAINED
        open_ones = [
            one
            for keys, one in done.items()
            if self.settles and (model := self.models[keys]) and model is same[model.keys]
            if not one[1].fit.is_settled and one[1].fit.log_evidence > least
        ]
        settled = in_order(self.executor, partial(settled_of, self.linear), open_ones)
        for (candidate, fitted), fit in zip(open_ones, settled, strict=True):
            if model := self.models[candidate.keys]:
                same[model.keys] = self._model(candidate, replace(fitted, fit=fit))
        self.models = {keys: same[model.keys] if model else None for keys, model in self.models.items()}
        models = (self.models[keys] for keys in dict.fromkeys(candidate.keys for candidate in candidates))
        unique = {model.keys: model for model in models if model is not None}
        return list(unique.values())

    def knows(self, model: Model, candidate: CandidateModel) -> CandidateModel:
        """Take a model that was fitted to the design already, and return its trial.

        One of which a cause explains nothing any more, or wants to be larger than plausible, is fitted again without
        that: the others are no worse for it.
        """
        known = self._model(candidate, Fitted(model.fit, tuple(range(len(candidate.causes)))))
        if known:
            self.models[candidate.keys] = known
        return candidate

    def fell_short(self, best: Model) -> dict[frozenset[Hashable], frozenset[Hashable]]:
        """Return what could not be fitted, or did not need all of its causes: its keys -> those that came to nothing.

        Args:
            best: The best model before; what it has can be fitted.
        """
        return {
            keys: keys - (model or best).keys
            for keys, model in self.models.items()
            if model is None or model.keys != keys
        }

    def _fits(self, new: Sequence[CandidateModel]) -> list[Fitted | None]:
        """Return what each candidate comes to; see `fit_of`.

        Where shapes have to be looked for, the first one does so for all that have the same causes.
        """
        least = max((model.fit.log_evidence for model in self.models.values() if model), default=-inf)
        new = [replace(self._begun(candidate), least=least) for candidate in new]
        fits = partial(fit_of, self.linear)
        if len(new) < 2 or new[0].shape or not starts_elsewhere(new[0]):
            return in_order(self.executor, fits, new)
        (first,) = in_order(self.executor, fits, new[:1])
        others = list(new[1:])
        if first:
            known = first.fit.with_causes(tuple(new[0].causes[i] for i in first.kept))
            others = [replace(one, start=one.start | known.start, known=known) for one in others]
        return [first, *in_order(self.executor, fits, others)]

    def _begun(self, candidate: CandidateModel) -> CandidateModel:
        """Return a candidate with the fit near it that is known."""
        if self.known:
            return replace(candidate, known=self.known)
        keys = {cause.key for cause in candidate.causes}
        shared = {i: sum(cause.key in keys for cause in fit.causes) for i, fit in enumerate(self.earlier)}
        if not any(shared.values()):
            return candidate
        nearest = self.earlier[max(shared, key=shared.__getitem__)]
        return replace(candidate, start=candidate.start | nearest.start, known=nearest)

    def _model(self, candidate: CandidateModel, fitted: Fitted) -> Model | None:
        causes = tuple(candidate.causes[i] for i in fitted.kept)
        fit = fitted.fit.with_causes(causes)
        if not all(fit.allows(cause) and fit.acts(cause) for cause in causes):
            return None
        if not causes and candidate.shape is None:
            return Model(self.null)
        odds = sum(
            candidate.log_odds[i] for i in (*fitted.kept, *range(len(candidate.causes), len(candidate.log_odds)))
        )
        evidence = fit.log_evidence - self.null.log_evidence + log_of_priors(fit)
        return Model(fit, candidate.shape, evidence, evidence + odds)


def reweighed(model: Model, before: LinearisedModel, linear: LinearisedModel) -> Model:
    """Return a model fitted again to a design that weighs its readings otherwise.

    Raises:
        ConvergenceError, RobotError: As `refitted`.
    """
    known = model.linear(before)
    if old := model.shape:  # as it is whitened now
        model = replace(model, shape=replace(old, columns=linear.whiten(before.unwhiten(old.columns))))
    weighed = model.linear(linear)
    # what friction held at rest does, and all else that is not simulated, is that of the design
    which = [i for i, nuisance in enumerate(weighed.nuisances) if not nuisance.is_simulated]
    change = (known.sensitivities[:, :, which] - weighed.sensitivities[:, :, which]) @ model.fit.nuisances[which]
    return replace(model, fit=refitted(weighed, replace(model.fit, residual=model.fit.residual + change)))


def without_shape(linear: LinearisedModel, count: int) -> LinearisedModel:
    """Return a design with its first nuisances alone."""
    if len(linear.nuisances) == count:
        return linear
    return replace(
        linear,
        nuisances=linear.nuisances[:count],
        sensitivities=linear.sensitivities[:, :, :count],
        jacobian=linear.jacobian[:, :count],
    )
