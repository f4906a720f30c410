"""Everything that may be wrong, linearised about a fitted model, to be searched; and what a search proposes to fit.

About a model with causes S, the residual is taken back to the model without them by simulating it without each of them,
and the sensitivities of S are corrected so that taking one cause away is exact (a secant condition, after Broyden,
1965): J' = J + (d - J x) x' / x'x, where x are the cause's sizes and d is what it changes.
"""

from collections.abc import Hashable, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.extend.fit import Fit, Key, fit_without, pseudo_residual
from bench.diagnose.extend.steps import bounded_step
from bench.diagnose.linearise.candidates import Candidate, Cause
from bench.diagnose.linearise.generic import Block
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.marginal import Columns, Nuisances
from bench.diagnose.linearise.screening import WIDTHS, Entry, Tried, widths_of
from bench.diagnose.linearise.threshold import LEAST
from bench.diagnose.name.candidate_model import CandidateModel
from bench.diagnose.name.first_values import first_bounds, first_values
from bench.diagnose.name.models import Model
from bench.diagnose.name.sizes import log_of_widths
from bench.diagnose.name.subset_posterior import SubsetPosterior, Term
from bench.effects.catalogue import FRICTION_LEFT_OUT
from bench.errors import NOT_SIMULATED
from bench.record.campaign import Array

GREATER_PART = 0.5  # assumed: of what a shape explains, or keeps of its evidence when simulated


@dataclass(frozen=True, eq=False)
class SearchSpace:
    """A campaign linearised about a model.

    Attributes:
        model: To search.
        about: The model.
        what: Of each term: something that was screened, or a cause of the model.
        tangents: Of each cause of the model, shape (m, k), whitened.
        white: Shape (m,), residual without any finding, whitened.
        nuisances: That are integrated out.
        threshold: Log evidence that chance exceeds at the declared rate.
        tried: What was screened.
    """

    model: SubsetPosterior
    about: Model
    what: tuple[Entry | Cause, ...]
    tangents: tuple[Array, ...]
    white: Array
    nuisances: Nuisances
    threshold: float
    tried: Tried

    def cause(self, i: int) -> Cause | None:
        """Return the cause that a term stands for; None for a free shape."""
        what = self.what[i]
        return what if isinstance(what, Cause) else what.cause

    @cached_property
    def _shapes(self) -> NDArray[np.intp]:
        """Indices of the free shapes."""
        return np.array([i for i, term in enumerate(self.model.terms) if not term.is_listed], dtype=np.intp)

    def beside(self, refused: Set[str] = frozenset()) -> CandidateModel | None:
        """Return the model that it is linearised about with the free shape that is needed most, None where none is.

        What is not listed is orthogonal to what the causes at its drive can do (Plumlee, Bayesian calibration of
        inexact computer models, 2017): else it would take the constant part of a friction from the level.
        """
        shapes = [int(i) for i in self._shapes if self.model.terms[i].key not in refused]
        rise = self.model.additions(self.present, listed=False)[shapes]
        if not len(rise) or np.max(rise) < 0:
            return None
        needed = shapes[int(np.argmax(rise))]
        found, block = self.what[needed], self._block(needed)
        assert isinstance(found, Entry)
        mine = [cause.drive == found.drive for cause in self.about.causes]
        tangents = [tangent for tangent, is_mine in zip(self.tangents, mine, strict=True) if is_mine]
        columns = block.columns
        if tangents:
            own = np.concatenate(tangents, axis=1)
            columns = np.asarray(columns - own @ self.nuisances.regression(own, columns))
        every = np.concatenate([*self.tangents, columns], axis=1)
        products = self.nuisances.products(self.white, every)
        terms = [i for i in self.present if isinstance(self.what[i], Cause)]
        prior = np.concatenate([np.empty(0), *(self.model.terms[i].prior for i in terms)])
        count = np.array(range(every.shape[1]))
        marginal, which = products.given(count[: len(prior)], prior), count[len(prior) :]
        evidence = [marginal.log_evidence(which, width) + share for width, share in found.priors]
        width, share = found.priors[int(np.argmax(evidence))]
        candidate = self.candidate_of(self.present)
        shape = replace(block, columns=columns, prior=float(width[0]))
        return replace(candidate, shape=shape, log_odds=(*candidate.log_odds, share - self.threshold - LEAST))

    def instead(self, which: Sequence[int]) -> tuple[int, ...]:
        """Return the free shape that is more probable than listed terms that it does without, with the others; or none.

        A shape is added to them, and what is then not needed is taken away, the least needed first. One that merely
        does as well as a single cause that explains most of it is not preferred to that: a robot that only lacks
        Coulomb friction would be called unlisted, for a torque over angle and direction holds that too. Several causes
        that one shape does without are a coincidence that it does not need: there the posterior decides. So it does
        where listed terms need a shape beside them (which is of what they leave): as it is, it may do without some.
        Friction that a drawing leaves out is no coincidence, for every drive has some: it does not pay for its odds.
        """
        before, has_shape = self.model.log_posterior(which), any(not self.model.terms[i].is_listed for i in which)
        listed = [i for i in which if self.model.terms[i].is_listed]
        found: tuple[int, ...] = ()
        best = before
        for shape in self._worth_trying(listed):
            kept, total = self._needed(listed, shape)
            gone = [i for i in listed if i not in kept]
            explained = total - self.model.log_posterior(kept[:-1])
            total += sum(self.model.terms[i].log_odds for i in gone if self._is_friction_left_out(i))
            if not gone or total <= best:
                continue
            if has_shape or len(gone) > 1 or explained - (total - before) < GREATER_PART * explained:
                found, best = kept, total
        return found

    def _is_friction_left_out(self, i: int) -> bool:
        cause = self.cause(i)
        return cause is not None and cause.effect.name in FRICTION_LEFT_OUT

    def _worth_trying(self, which: Sequence[int]) -> list[int]:
        """Return the free shapes that explain most in the place of all terms, of those at each drive, and of none."""
        if not len(self._shapes):
            return []
        drives = sorted({self.what[i].drive for i in which})
        rests = [[], *([i for i in which if self.what[i].drive != drive] for drive in drives), which]
        rises = (self.model.additions(rest, listed=False)[self._shapes] for rest in rests)
        best = (int(self._shapes[np.argmax(rise)]) for rise in rises)
        return list(dict.fromkeys(best))

    def _needed(self, which: Sequence[int], shape: int) -> tuple[tuple[int, ...], float]:
        """Return the terms that are needed beside a free shape, and it; and the logarithm of their posterior odds."""
        kept = list(which)
        total = self.model.log_posterior([*kept, shape])
        while kept:
            without = [self.model.log_posterior([*(i for i in kept if i != gone), shape]) for gone in kept]
            if max(without) < total:
                break
            total = max(without)
            del kept[int(np.argmax(without))]
        return (*kept, shape), total

    def _block(self, i: int) -> Block:
        """Return the free shape that a term stands for, with its columns."""
        entry = self.what[i]
        assert isinstance(entry, Entry)
        assert isinstance(entry.what, Block)
        return entry.what if i in self.shape else replace(entry.what, columns=self.tried.columns_of(entry))

    @property
    def present(self) -> tuple[int, ...]:
        """The terms of the model that it is linearised about."""
        return tuple(range(len(self.what) - len(self.about.keys), len(self.what)))

    @property
    def shape(self) -> tuple[int, ...]:
        """The term of that model's free shape; none where it has none."""
        return self.present[-1:] if self.about.shape else ()

    def candidate_of(self, which: Sequence[int]) -> CandidateModel:
        """Return the model of some terms, to be fitted from what the linearised model says of their sizes.

        The fit that begins there has bounds. A size that the linearised model wants beyond them stops there, and the
        others are those that are most probable beside it: a payload of -29 kg left its moments without a mass, and
        friction that had to make up for it.
        """
        start: dict[Key, float] = {}
        causes: list[Cause] = []
        shape: Block | None = None
        sizes = np.empty(0)
        if len(which):
            bounds = [first_bounds(self.what[i], len(self.model.terms[i].columns)) for i in which]
            sizes = bounded_step(*self.model.equations(which), *np.concatenate(bounds, axis=1))
        of_shape: tuple[float, ...] = ()
        for i in which:
            term, what = self.model.terms[i], self.what[i]
            mine, sizes = sizes[: len(term.columns)], sizes[len(term.columns) :]
            if isinstance(what, Cause):
                causes.append(what)
                start |= {key: value for key, value in self.about.fit.start.items() if key[:2] == what.key}
            elif isinstance(what.what, Candidate):
                causes.append(what.what.cause)
                start |= first_values(what.what, mine)
            else:
                shape, of_shape = replace(self._block(i), prior=float(term.prior[0])), (term.log_odds,)
        order = {cause.key: place for place, cause in enumerate(self.about.causes)}
        causes.sort(key=lambda cause: order.get(cause.key, len(order)))
        # the nominal model's figures are bent by what is missing: no place to start from
        nuisances = self.about.fit.nuisances if self.about.keys else None
        if nuisances is not None and self.about.shape:
            nuisances = nuisances[: len(nuisances) - self.about.shape.columns.shape[1]]
        log_odds = (*[-self.threshold] * len(causes), *of_shape)  # a fit weighs shapes and widths of a cause itself
        return CandidateModel(tuple(causes), shape, start, nuisances, log_odds)


def search_space(
    linear: LinearisedModel, tried: Tried, threshold: float, about: Model, refused: frozenset[Hashable] = frozenset()
) -> SearchSpace:
    """Return everything linearised about a model.

    Args:
        linear: The campaign.
        tried: Everything that can be tried, as this design whitens it.
        threshold: Log evidence that chance exceeds at the declared rate: less it, evidence is posterior odds. For a
            free shape nothing but its evidence speaks, so it is taken to be a hundred times less likely.
        about: The model.
        refused: Keys of what is not tried.
    """
    fit, its_design = about.fit, about.linear(linear)
    white = pseudo_residual(its_design, fit)
    own = []
    for cause in about.causes:
        removed, tangent = _removal(its_design, fit, cause)
        white = white + removed
        own.append(tangent)
    shape = [about.shape.columns] if about.shape else []
    mine = np.concatenate([*own, *shape], axis=1) if about.keys else np.empty((len(white), 0))
    nuisances = Nuisances(linear.jacobian)
    marginal = nuisances.products(white, tried.columns)
    second = nuisances.products(white, Columns(mine))
    cross = tried.columns.matrix.T @ mine - marginal.reduced.T @ second.reduced
    information = np.block([[marginal.information, cross], [cross.T, second.information]])
    scores = np.concatenate([marginal.scores, second.scores])
    taken = {cause.key for cause in about.causes}
    terms: list[Term] = []
    what: list[Entry | Cause] = []
    for entry in tried.entries:
        key = entry.cause.key if entry.cause else str(entry.what)
        if key in taken or key in refused:
            continue
        for prior, log_odds in entry.priors:
            log_odds -= threshold if entry.cause else threshold + LEAST
            needs = tried.needs.get(key, frozenset())
            terms.append(Term(key, entry.columns, prior, log_odds, entry.sign, entry.cause is not None, needs))
            what.append(entry)
    start = len(marginal.scores)
    for cause, tangent in zip(about.causes, own, strict=True):
        columns = np.arange(start, start + tangent.shape[1])
        start += tangent.shape[1]
        unknowns = [unknown for unknown in fit.unknowns if unknown.cause is cause]
        sigma = np.array([unknown.sigma for unknown in unknowns])
        sign = np.array([0.0 if u.parameter.is_shape or u.parameter.signed else 1.0 for u in unknowns])
        widths = widths_of(cause)
        width = widths[int(np.argmax(log_of_widths(fit, cause)))]
        prior = np.where([u.parameter.is_shape for u in unknowns], 1.0, width) * sigma
        log_odds, needs = -threshold - float(np.log(len(widths))), tried.needs.get(cause.key, frozenset())
        terms.append(Term(cause.key, columns, prior, log_odds, sign, needs=needs))
        what.append(cause)
    if about.shape:
        log_odds = -float(np.log(len(WIDTHS)))
        its = np.array(range(start, len(scores)))
        entry = Entry(about.shape, its, ((about.shape.plausible, log_odds),))
        log_odds -= threshold + LEAST
        terms.append(Term(str(about.shape), its, about.shape.plausible, log_odds, entry.sign, False))
        what.append(entry)
    model = SubsetPosterior(information, scores, terms)
    return SearchSpace(model, about, tuple(what), tuple(own), white, nuisances, threshold, tried)


def _removal(linear: LinearisedModel, fit: Fit, cause: Cause) -> tuple[Array, Array]:
    """Return what a cause changes, shape (m,), and the sensitivities to its parameters, shape (m, k), both whitened."""
    mine, sizes = fit.sizes_of(cause)
    tangent = linear.whiten(fit.jacobian[:, :, mine])
    try:
        removed = linear.whiten(fit_without(linear, fit, cause).residual - fit.residual)
    except NOT_SIMULATED:  # without it the model finds no balance along the measured motion
        removed = tangent @ sizes
    # in units of each prior, so that sizes of different units count alike
    scale = np.array([fit.unknowns[i].sigma for i in mine])
    x = sizes / scale
    if np.any(x):
        tangent = tangent + np.outer(removed - tangent @ sizes, x / (x @ x)) / scale
    return removed, tangent
