"""One model that extends the nominal one by findings: where its fit starts, and what it comes to, by simulation."""

from collections.abc import Callable, Hashable, Iterable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from math import inf

import numpy as np

from bench.diagnose.extend.fit import Fit, Key
from bench.diagnose.extend.refit import FAR, refit, refitted
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.generic import Block
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.replay.nuisances import Nuisance
from bench.errors import NOT_SIMULATED
from bench.executor.contract import Progress
from bench.record.campaign import Array

# effort: ratio of neighbouring shapes below which an effect is lost between two of them: more starts are tried
NARROW = 1.5


@dataclass(frozen=True)
class CandidateModel:
    """A model that is to be fitted.

    Attributes:
        causes: Listed.
        shape: Not listed, or None.
        start: First values of the parameters.
        nuisances: First values, shape (p,), without those of the shape; None: zeros.
        log_odds: Logarithm of the prior odds of each cause, in their order, and of the shape, if there is one.
        known: Fit near the start, whose derivatives will do as long as they promise what comes true; or None.
        least: As of `refit`.
    """

    causes: tuple[Cause, ...]
    shape: Block | None
    start: dict[Key, float]
    nuisances: Array | None
    log_odds: tuple[float, ...]
    known: Fit | None = None
    least: float = -inf

    @property
    def keys(self) -> frozenset[Hashable]:
        """As of the model."""
        shape = {str(self.shape)} if self.shape else set()
        return frozenset({cause.key for cause in self.causes} | shape)


def with_shape(linear: LinearisedModel, shape: Block) -> LinearisedModel:
    """Return a design that has a free shape among its nuisances; it acts by its changes alone.

    Args:
        linear: The campaign.
        shape: As this design whitens it.
    """
    jacobian = shape.columns * shape.prior
    nuisances = tuple(Nuisance(f"{shape}, {i + 1}", shape.unit, shape.prior) for i in range(jacobian.shape[1]))
    return replace(
        linear,
        nuisances=(*linear.nuisances, *nuisances),
        sensitivities=np.concatenate([linear.sensitivities, linear.unwhiten(jacobian)], axis=2),
        jacobian=np.concatenate([linear.jacobian, jacobian], axis=1),
    )


@dataclass(frozen=True)
class Fitted:
    """What a candidate came to.

    Attributes:
        fit: The best one, of the causes that it needs and allows; without them, so that it passes between processes.
        kept: Indices of these among the candidate's.
        too_large: Indices of those that wanted to be larger than plausible.
    """

    fit: Fit
    kept: tuple[int, ...]
    too_large: tuple[int, ...] = ()


def fit_of(plain: LinearisedModel, candidate: CandidateModel, progress: Progress) -> Fitted | None:
    """Return what a candidate comes to; None: nothing.

    That is where nothing balances along the motion, or where it stays far behind other models.
    """
    linear, nuisances, known = plain, candidate.nuisances, candidate.known
    if candidate.shape:
        linear = with_shape(plain, candidate.shape)
        if nuisances is not None:
            nuisances = np.concatenate([nuisances, np.zeros(len(linear.nuisances) - len(nuisances))])
    quickly = partial(refit, linear, settles=False, least=candidate.least, progress=progress)
    fits = partial(quickly, candidate.causes, nuisances=nuisances, known=known)
    try:
        if elsewhere := starts_elsewhere(candidate):
            best = _best_of(partial(fits, renews=False), candidate.start, elsewhere)
            found = fits(start=best.start, nuisances=best.nuisances, known=best) if best else None
        else:
            found = fits(start=candidate.start)
        if found is None:
            return None
        too_large: set[int] = set()
        while len(needed := needed_of(found)) < len(found.causes):
            too_large |= {candidate.causes.index(cause) for cause in found.causes if not found.allows(cause)}
            found = quickly(needed, found.start, found.nuisances, found)
    except NOT_SIMULATED:
        return None
    if found.log_evidence < candidate.least - FAR:
        return None
    kept = tuple(i for i, cause in enumerate(candidate.causes) if cause in found.causes)
    return Fitted(found.with_causes(()), kept, tuple(sorted(too_large)))


def _best_of(
    fits: Callable[..., Fit], start: dict[Key, float], elsewhere: Iterable[tuple[dict[Key, float], Cause]]
) -> Fit | None:
    """Return the most probable fit of several starts, no derivative taken twice; None where none can be simulated.

    Args:
        fits: Fits from a start.
        start: As the linearised model says.
        elsewhere: As of `starts_elsewhere`.
    """
    first: Fit | None = None
    with suppress(*NOT_SIMULATED):
        first = fits(start=start)
    best = first
    for other, cause in elsewhere:
        shared = {"known": first.elsewhere(cause)} if first else {}
        with suppress(*NOT_SIMULATED):
            found = fits(start=other, **shared)
            if best is None or found.log_evidence > best.log_evidence:
                best = found
    return best


def settled_of(plain: LinearisedModel, done: tuple[CandidateModel, Fitted], progress: Progress) -> Fit:
    """Return a fit brought to its end by derivatives of all nuisances about itself; see `fit_of`."""
    candidate, fit = done[0], done[1].fit
    causes = tuple(candidate.causes[i] for i in done[1].kept)
    linear = with_shape(plain, candidate.shape) if candidate.shape else plain
    try:
        found = refitted(linear, fit.with_causes(causes), progress)
    except NOT_SIMULATED:
        return fit
    return found.with_causes(())


def needed_of(fit: Fit) -> tuple[Cause, ...]:
    """Return the causes of a fit without those that explain nothing, or that want to be larger than plausible.

    One that is too large is no reason to do without twenty others that were tried with it.
    """
    return tuple(cause for cause in fit.causes if fit.acts(cause) and fit.allows(cause))


def starts_elsewhere(candidate: CandidateModel) -> list[tuple[dict[Key, float], Cause]]:
    """Return where to start besides, as the linearised model may be far off, each with the cause that is elsewhere.

    Between the shapes tried, where those lie far apart; and from the largest size of a play, for less of it explains
    as well with more noise, so a fit may stay at the smaller of two sizes.
    """
    old = {cause.key for cause in candidate.known.causes} if candidate.known else set()
    starts = []
    for cause in candidate.causes:
        if cause.key in old:
            continue
        for shape in cause.shapes:
            if shape.ratio < NARROW:
                key = (*cause.key, shape.name)
                value = candidate.start.get(key, shape.null)
                starts += [(candidate.start | {key: value * shape.ratio ** (side / 3)}, cause) for side in (-1, 1)]
        if cause.effect.scatters:
            starts.append((candidate.start | {(*cause.key, size.name): size.high for size in cause.sizes}, cause))
    return starts
