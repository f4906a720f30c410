"""Name: what the data say. Causes, sets of what cannot be told apart, several causes, or none that is listed."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal

import numpy as np
from scipy.special import logsumexp

from bench.diagnose.cross_validation.held_out import HeldOut
from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.generic import Block
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.screening import Screening, Tried
from bench.diagnose.name.groups import IN_SET, AmbiguityGroup
from bench.diagnose.name.models import Model
from bench.diagnose.name.search import Alternative

NOTHING: Mapping[frozenset[Hashable], frozenset[Hashable]] = MappingProxyType({})
Kind = Literal["nothing found", "cause", "several causes", "unlisted cause", "nothing found so far"]


@dataclass(frozen=True, eq=False)
class Finding:
    """What one cause of the best model is worth beside all the others, or of one that was refused.

    Attributes:
        cause: The cause.
        fit: With it.
        without: Fit of the model without it, as long as it may be refused; None: nobody needs it.
        log_evidence: By how much the logarithm of the evidence falls without it.
        held_out: What it is worth on what was held out.
        is_taken: Whether the model keeps it.
        repeats: Share of searches, each without a part of the runs, that find it or what stands in its place again.
    """

    cause: Cause
    fit: Fit
    without: Fit | None
    log_evidence: float
    held_out: HeldOut
    is_taken: bool
    repeats: float = float("nan")


@dataclass(frozen=True, eq=False)
class Naming:
    """What the data say.

    Attributes:
        kind: In a word.
        models: Fitted, the most probable first; the nominal one is left out. Empty for nothing found.
        null: Fit of the nominal model.
        screening: Everything that was tried against the nominal model.
        findings: Of the best model, the one with the most evidence first; then those that were refused.
        linear: The campaign linearised about the best model, its standard errors.
        tried: Everything that can be tried on the best model, as `linear` whitens it.
        groups: Of each listed finding of the best model, what could stand in its place.
        promising: Causes that the last search found likely and that were not fitted.
        stopped: Why the search ended early; "" where it did not.
        plays_beyond: Plays that a fit wanted to be larger than plausible.
    """

    kind: Kind
    models: tuple[Model, ...]
    null: Fit
    screening: Screening
    findings: tuple[Finding, ...]
    linear: LinearisedModel
    tried: Tried
    groups: tuple[AmbiguityGroup, ...] = ()
    promising: tuple[Cause, ...] = ()
    stopped: str = ""
    plays_beyond: frozenset[Hashable] = frozenset()

    @property
    def unlisted(self) -> Block | None:
        """The free shape in the best model."""
        return self.models[0].shape if self.models else None

    @property
    def found(self) -> frozenset[tuple[str, str]]:
        """Effect and place of every cause that may be behind a finding, and of what it covers."""
        causes = [cause for model in self.models[:1] for cause in model.causes]
        causes += [member.cause for group in self.groups for member in group.members]
        return frozenset((name, one.key[1]) for one in causes for name in (one.effect.name, *one.effect.covers))

    @property
    def alternatives(self) -> tuple[Model, ...]:
        """Models that these data cannot tell from the best, the best first.

        One that has all that a likelier one has and something more says the same, less surely, and is left out.
        """
        near = [m for m in self.models if m.log_posterior > self.models[0].log_posterior - IN_SET]
        return tuple(m for i, m in enumerate(near) if not any(better.keys < m.keys for better in near[:i]))


def log_odds_of_subsets(
    models: Sequence[Model],
    found: Sequence[Alternative],
    fell: Mapping[frozenset[Hashable], frozenset[Hashable]] = NOTHING,
    most: float = np.inf,
) -> dict[frozenset[Hashable], float]:
    """Return the logarithm of the posterior odds of every subset that was visited.

    What was not simulated counts as linearised, shifted by what simulation made of the best, and for no more than the
    least of those that promised more. A cause that came to nothing where more was promised counts for nothing.

    Args:
        models: Simulated, the most probable first.
        found: By the search.
        fell: What was promised and not borne out by a simulation -> which of its causes came to nothing.
        most: That anything counts for that was not simulated.
    """
    simulated = {model.keys: model.log_posterior for model in models}
    linear = {one.keys: one.log_posterior for one in found}
    offset = simulated[models[0].keys] - linear.get(models[0].keys, simulated[models[0].keys])
    tried = [(linear[keys], value) for keys, value in simulated.items() if keys in linear]
    lost = [(linear[keys], gone) for keys, gone in fell.items() if keys in linear]

    def expected(keys: frozenset[Hashable], value: float) -> float:
        if keys in fell or any(promised >= value and keys & gone for promised, gone in lost):
            return -np.inf
        return min([value + offset, most, *(made for promised, made in tried if promised >= value)])

    return {keys: expected(keys, value) for keys, value in linear.items()} | simulated


def with_probabilities(models: Sequence[Model], every: Mapping[frozenset[Hashable], float]) -> tuple[Model, ...]:
    """Return models with the probability that all of their findings are at work, among everything that was visited.

    What has all findings of a likelier model and more counts for that model.

    Args:
        models: Simulated, the most probable first.
        every: Logarithm of the posterior odds of every subset, from `log_odds_of_subsets`.
    """
    mass = shares_of(every)
    return tuple(replace(model, probability=mass.get(model.keys, 0.0)) for model in models)


def fitted_probabilities(models: Sequence[Model]) -> tuple[float, ...]:
    """Return the probabilities of models as their simulations share them, in all as much as they have together.

    Of a subset that was not simulated nothing is known but what it is not above, so it says how probable all of these
    models are, not which of them: as for the names of a finding (`groups.py`).

    Args:
        models: With probabilities.
    """
    mass = shares_of({model.keys: model.log_posterior for model in models})
    total = sum(model.probability for model in models)
    return tuple(total * mass.get(model.keys, 0.0) for model in models)


def shares_of(every: Mapping[frozenset[Hashable], float]) -> dict[frozenset[Hashable], float]:
    """Return subset -> its share of all; what has all findings of a likelier one and more counts for that one.

    Those that count for another one are not among them.

    Args:
        every: Logarithm of the posterior odds of every subset.
    """
    total = float(logsumexp(list(every.values())))
    mass: dict[frozenset[Hashable], float] = {}
    for keys in sorted(every, key=lambda keys: -every[keys]):
        whose = next((other for other in mass if other and other < keys), keys)
        mass[whose] = mass.get(whose, 0.0) + float(np.exp(every[keys] - total))
    return mass
