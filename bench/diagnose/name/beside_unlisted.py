"""What listed causes are worth beside something unlisted, of which nobody knows the form.

A model with a free shape says that something is missing at a drive. The shape is the best of a handful, and what it
depends on is not known. So the discrepancy is any sum of the shapes at that drive, over angle, direction, speed, load
and reading, each with a variance of its own, which may be none (Kennedy and O'Hagan, Bayesian calibration of computer
models, 2001). It is integrated out together with all listed causes S:

    odds of a cause C = sum of p(data | S, discrepancy) / sum of p(data | S - C, discrepancy), over its variances

C has the evidence that the discrepancy cannot take, and pays its prior odds from that. Viscous friction beside a drag
over speed has none left: the shape is needed in any case, and holds a straight line as well. Coulomb friction beside a
torque over the angle keeps its own, for a second shape would be needed in its place, with one value at each node.
"""

from collections import Counter
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.special import expit, logsumexp

from bench.diagnose.extend.fit import Fit
from bench.diagnose.linearise.candidates import Candidate, Cause
from bench.diagnose.linearise.generic import Block, blocks_at
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.screening import WIDTHS, tried_of
from bench.diagnose.linearise.threshold import LEAST
from bench.diagnose.name.discrepancy import ANGLE_NODES, Discrepancy
from bench.diagnose.name.groups import IN_SET, LEVEL, AmbiguityGroup, Member
from bench.diagnose.name.models import Model, log_of_widths
from bench.diagnose.name.naming import Naming
from bench.diagnose.name.search import SubsetPosterior, Term, search
from bench.diagnose.name.search_space import search_space

EXPANDED = 8  # effort: sums of shapes whose neighbours are looked at

Odds = dict[Hashable, float]  # key of a cause -> logarithm of its posterior odds against none of those in its place


def beside_unlisted(
    naming: Naming, discrepancy: Discrepancy | None, listed: Callable[[LinearisedModel], Sequence[Candidate]]
) -> Naming:
    """Return a naming with the names and probabilities that its findings have where what is unlisted is free.

    Args:
        naming: What the data say.
        discrepancy: What became of its free shape. Where a model runs with that, it is linearised about.
        listed: Returns everything that may stand in the place of a finding, as a design whitens it.
    """
    if naming.unlisted is None or not naming.groups:
        return naming
    linear, learned = naming.linear, None
    fit = naming.models[0].listed_fit(linear)
    if discrepancy and discrepancy.fit and discrepancy.is_gain:
        linear, fit, learned = discrepancy.linear, discrepancy.fit, discrepancy.cause
    tried = listed(linear)
    causes: dict[Hashable, Cause] = {cause.key: cause for cause in (*(one.cause for one in tried), *fit.causes)}
    odds = odds_beside(linear, fit, naming.unlisted, learned, tried, naming.screening.threshold)
    groups = []
    for group in naming.groups:
        own = next((key for key in group.keys if key in odds), None)
        groups.append(group if own is None else group_of(own, odds[own], causes, group.probability))
    return replace(naming, groups=tuple(groups))


def group_of(own: Hashable, odds: Odds, causes: Mapping[Hashable, Cause], most: float) -> AmbiguityGroup:
    """Return what could stand in the place of a finding.

    Args:
        own: Key of the finding, as fitted.
        odds: Of it and of what could stand in its place.
        causes: Key -> cause.
        most: Probability that any of them acts where the shape is as it was found; it does not become surer.
    """
    total = float(logsumexp(list(odds.values())))
    acts = float(expit(total))
    shares = {key: float(np.exp(value - total)) for key, value in odds.items()}
    ranked = sorted(shares, key=lambda key: (-shares[key], key != own, str(key)))
    count = 1 + int(np.searchsorted(np.cumsum([shares[key] for key in ranked]), LEVEL))
    probability = min(most, acts)
    members = tuple(Member(causes[key], probability * shares[key]) for key in ranked[:count])
    return AmbiguityGroup(members, probability, may_be_unlisted=acts < LEVEL)


def odds_beside(
    linear: LinearisedModel,
    fit: Fit,
    block: Block,
    learned: Cause | None,
    listed: Sequence[Candidate],
    threshold: float,
) -> dict[Hashable, Odds]:
    """Return the odds of each listed cause of a fit, and of what could stand in its place, beside a free discrepancy.

    Args:
        linear: The campaign.
        fit: Of listed causes, with the learned shape or without it.
        block: The free shape that was found.
        learned: The same as a cause of the fit; None: it has none.
        listed: What could stand in the place of a cause.
        threshold: Log evidence that chance exceeds at the declared rate: less it, evidence is posterior odds.
    """
    tried = tried_of([*listed, *blocks_at(linear, block.drive, ANGLE_NODES)])
    space = search_space(linear, tried, threshold, Model(fit))
    terms = {i: term for i, term in enumerate(space.model.terms) if space.what[i] is not learned}
    shapes = [term for i, term in terms.items() if space.cause(i) is None]
    if learned is not None:
        own = space.model.terms[space.present[fit.causes.index(learned)]]
        prior = next((shape.prior[0] / WIDTHS[0] for shape in shapes if shape.key == str(block)), own.prior[0])
        shapes += [replace(own, key=str(block), prior=np.full(len(own.columns), w * prior)) for w in WIDTHS]
    causes = [term for i, term in terms.items() if space.cause(i) is not None]
    acting: dict[Hashable, Cause] = {cause.key: cause for cause in fit.causes if cause is not learned}
    model = SubsetPosterior(space.model.information, space.model.scores, free_beside(shapes, causes, threshold))
    found = log_odds(model, tuple(i for i, term in enumerate(model.terms) if term.key in acting))
    for key, odds in found.items():
        fall = max(odds[key] - log_odds_as_runs_say(fit, acting[key], threshold), 0.0)
        found[key] = {one: value - fall for one, value in odds.items()}
    return found


def log_odds_as_runs_say(fit: Fit, cause: Cause, threshold: float) -> float:
    """Return the logarithm of the posterior odds of a cause of a fit by standard errors that count how runs disagree.

    With the sizes x, their covariance C and the prior P^2 the evidence is x' C^-1 x / 2 + log det(C P^-2) / 2. Where a
    learned shape is a little wrong everywhere, runs may each want another size of what stands beside it.

    Args:
        fit: With the cause and the learned shape.
        cause: Listed.
        threshold: Less it, evidence is posterior odds.
    """
    mine = [i for i, one in enumerate(fit.unknowns) if one.cause is cause and not one.parameter.is_shape]
    if not np.all(fit.sigma[mine] > 0):
        return float("inf")
    prior = np.array([fit.unknowns[i].sigma for i in mine])
    sizes = np.array([fit.values[i] - fit.unknowns[i].parameter.null for i in mine]) / prior
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


def log_odds(model: SubsetPosterior, acting: tuple[int, ...]) -> dict[Hashable, Odds]:
    """Return the odds of each cause beside all others, and of what could stand in its place, summed over what is free.

    Args:
        model: Causes, and what a search may add to them.
        acting: Indices of the causes that act.
    """
    with_all = search(model, (), acting, EXPANDED)
    found = {}
    for cause in acting:
        others = tuple(i for i in acting if i != cause)
        without = search(model, [_free(model, with_all[0].terms)], others, EXPANDED)
        near = {
            _free(model, one.terms)
            for some in (with_all, without)
            for one in some
            if one.log_posterior > some[0].log_posterior - IN_SET
        }
        none = np.array([model.log_posterior((*free, *others)) for free in near])
        own = logsumexp([model.log_posterior((*free, *acting)) for free in near]) - logsumexp(none)
        rises = np.array([model.additions((*free, *others)) for free in near])
        each = logsumexp(none[:, None] + rises, axis=0) - logsumexp(none)
        places: dict[Hashable, list[float]] = {}
        for i, term in enumerate(model.terms):
            if i not in acting and not term.is_listed and each[i] > max(own - IN_SET, 0.0):
                places.setdefault(term.key, []).append(float(each[i]))
        found[model.terms[cause].key] = {
            model.terms[cause].key: float(own),
            **{key: float(logsumexp(values)) for key, values in places.items()},
        }
    return found


def _free(model: SubsetPosterior, terms: Sequence[int]) -> tuple[int, ...]:
    return tuple(i for i in terms if model.terms[i].is_listed)
