"""What listed causes are worth beside something unlisted, of which nobody knows the form.

A model with a free shape says that something is missing at a drive. The shape is the best of a handful, and what it
depends on is not known. So the discrepancy is any sum of the shapes at that drive, over angle, direction, speed, load
and reading, each with a variance of its own and the prior odds of something unlisted (Kennedy and O'Hagan, Bayesian
calibration of computer models, 2001). It is integrated out together with all listed causes S:

    odds of a cause C = sum of p(data | S, discrepancy) / sum of p(data | S - C, discrepancy), over its variances

C has the evidence that the discrepancy cannot take, and pays its prior odds from that. A shape that is needed in any
case takes all that it can hold, however large that is: viscous friction beside a drag over speed has no evidence left,
for the shape holds a straight line as well. Coulomb friction beside a torque over the angle keeps its own, for a second
shape would be needed in its place, with one value at each node.
"""

from collections import Counter
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.special import expit, logsumexp

from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.generic import Block, blocks_at
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.screening import WIDTHS, tried_of
from bench.diagnose.linearise.threshold import LEAST
from bench.diagnose.name.discrepancy import ANGLE_NODES, Discrepancy
from bench.diagnose.name.groups import IN_SET, LEVEL, AmbiguityGroup
from bench.diagnose.name.models import Model
from bench.diagnose.name.naming import Naming
from bench.diagnose.name.search import search
from bench.diagnose.name.search_space import search_space
from bench.diagnose.name.sizes import log_of_widths
from bench.diagnose.name.subset_posterior import SubsetPosterior, Term

FLAT = 1e3  # rounding: times its prior; a shape that is needed in any case holds whatever it can
EXPANDED = 8  # effort: sums of shapes whose neighbours are looked at


def beside_unlisted(naming: Naming, discrepancy: Discrepancy | None) -> Naming:
    """Return a naming with the probabilities that its findings have where what is unlisted is free.

    Args:
        naming: What the data say.
        discrepancy: What became of its free shape. Where a model runs with that, it is linearised about.
    """
    if naming.unlisted is None or not naming.groups:
        return naming
    linear, learned = naming.linear, None
    fit = naming.models[0].listed_fit(linear)
    if discrepancy and discrepancy.fit and discrepancy.is_gain:
        linear, fit, learned = discrepancy.linear, discrepancy.fit, discrepancy.cause
    odds = log_odds_of(linear, fit, naming.unlisted, learned, naming.screening.threshold)
    return replace(naming, groups=tuple(group_beside(group, odds) for group in naming.groups))


def group_beside(group: AmbiguityGroup, odds: Mapping[Hashable, float]) -> AmbiguityGroup:
    """Return a group with the probability that it has beside the discrepancy; its names cannot be told apart.

    Args:
        group: Of a finding, beside the shape as it was found; it does not become surer.
        odds: Key -> logarithm of the posterior odds, of the findings as fitted.
    """
    fitted = [odds[key] for key in group.keys if key in odds]
    if not fitted:
        return group
    acts = float(expit(fitted[0]))
    probability = min(acts, group.probability)
    share = probability / group.probability if group.probability > 0 else 0.0
    members = tuple(replace(member, probability=member.probability * share) for member in group.members)
    return AmbiguityGroup(members, probability, may_be_unlisted=acts < LEVEL)


def log_odds_of(
    linear: LinearisedModel, fit: Fit, block: Block, learned: Cause | None, threshold: float
) -> dict[Hashable, float]:
    """Return the logarithm of the posterior odds of each listed cause of a fit, where the discrepancy is free.

    Args:
        linear: The campaign.
        fit: Of listed causes, with the learned shape or without it.
        block: The free shape that was found.
        learned: The same as a cause of the fit; None: it has none.
        threshold: Log evidence that chance exceeds at the declared rate: less it, evidence is posterior odds.
    """
    space = search_space(linear, tried_of(blocks_at(linear, block.drive, ANGLE_NODES)), threshold, Model(fit))
    count = len(space.present)
    shapes, causes = list(space.model.terms[:-count]), list(space.model.terms[-count:])
    listed = [cause for cause in fit.causes if cause is not learned]
    if learned is not None:
        own = causes.pop(fit.causes.index(learned))
        prior = next(iter(shape.prior / WIDTHS[0] for shape in shapes if shape.key == str(block)), own.prior)[:1]
        shapes += [replace(own, key=str(block), prior=np.tile(width * prior, len(own.columns))) for width in WIDTHS]
    if not causes:
        return {}
    model = SubsetPosterior(space.model.information, space.model.scores, free_beside(shapes, causes, threshold))
    free = log_odds(model)
    return {cause.key: min(free[cause.key], log_odds_as_runs_say(fit, cause, threshold)) for cause in listed}


def log_odds_as_runs_say(fit: Fit, cause: Cause, threshold: float) -> float:
    """Return the logarithm of the posterior odds of a cause of a fit by standard errors that count how runs disagree.

    With the sizes x, their covariance C and the prior P^2 the evidence is x' C^-1 x / 2 + log det(C P^-2) / 2. Where a
    learned shape is a little wrong everywhere, runs may each want another size of what stands beside it.

    Args:
        fit: With the cause and the learned shape.
        cause: Listed.
        threshold: Less it, evidence is posterior odds.
    """
    mine = fit.where(cause)
    if not np.all(fit.sigma[mine] > 0):
        return float("inf")
    prior = np.array([fit.unknowns[i].sigma for i in mine])
    sizes = fit.off[mine] / prior
    variance, axes = np.linalg.eigh(fit.covariance[np.ix_(mine, mine)] / np.outer(prior, prior))
    variance = np.minimum(variance, 1.0)  # nothing is known worse than by its prior
    evidence = 0.5 * np.sum((axes.T @ sizes) ** 2 / variance) + 0.5 * np.sum(np.log(variance))
    return float(evidence + logsumexp(log_of_widths(fit, cause)) - threshold)


def free_beside(shapes: Sequence[Term], causes: Sequence[Term], threshold: float) -> list[Term]:
    """Return shapes that a search may add, then causes, which it may not.

    Each kind of shape has the prior odds of something unlisted, which its variances and numbers of nodes share.
    """
    ways = Counter(shape.key for shape in shapes)
    odds = {key: -threshold - LEAST - float(np.log(count)) for key, count in ways.items()}
    return [
        *(replace(one, log_odds=odds[one.key], is_listed=True) for one in shapes),
        *(replace(cause, is_listed=False) for cause in causes),
    ]


def log_odds(model: SubsetPosterior) -> dict[Hashable, float]:
    """Return the logarithm of the posterior odds of each cause beside all others, summed over what is free.

    Odds are no better than where the shapes that are needed beside all causes have any size: how large what is not
    listed may be is known of its kind at best, and a cause that differs from it by its prior alone is not told from it.

    Args:
        model: Causes, and what a search may add to them.
    """
    every = tuple(i for i, term in enumerate(model.terms) if not term.is_listed)
    with_all = search(model, (), every, EXPANDED)
    needed = _free(model, with_all[0].terms)
    terms = [replace(term, prior=FLAT * term.prior) if term.is_listed else term for term in model.terms]
    wide = SubsetPosterior(model.information, model.scores, terms)
    found = {}
    for cause in every:
        others = tuple(i for i in every if i != cause)
        without = search(model, [needed], others, EXPANDED)
        near = {
            _free(model, one.terms)
            for some in (with_all, without)
            for one in some
            if one.log_posterior > some[0].log_posterior - IN_SET
        }
        has, has_not = (
            logsumexp([model.log_posterior((*free, *causes)) for free in near]) for causes in (every, others)
        )
        alone = wide.log_posterior((*needed, *every)) - wide.log_posterior((*needed, *others))
        found[model.terms[cause].key] = float(min(has - has_not, alone))
    return found


def _free(model: SubsetPosterior, terms: Sequence[int]) -> tuple[int, ...]:
    return tuple(i for i in terms if model.terms[i].is_listed)
