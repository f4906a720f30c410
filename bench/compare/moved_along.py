"""What may have moved along with a change, and what that leaves open of its size.

Wear, preload and lubricant act on all friction of a drive. Where Coulomb friction grew by a share x, its viscous and
load friction and its Stribeck effect may have grown by as large a share of theirs. Each alone is too small to be named,
and what it adds looks like more of what is. So sizes are averaged over two machines that are as likely until the
recordings are seen: one in which nothing else changed, and one in which each of the others did, with a standard
deviation of |x| times what there may be of it: the level that the model has, or what is plausible, as of what stayed.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import expit

from bench.compare.background import Background
from bench.compare.search_changes import Found, Possible, sizes_of
from bench.diagnose.linearise.candidates import Candidate, Cause
from bench.diagnose.linearise.screening import Entry
from bench.record.campaign import Array


@dataclass(frozen=True, eq=False)
class Along:
    """What may have moved along with the changes of an explanation; m whitened readings.

    Attributes:
        causes: Of each change, in its order.
        columns: Shape (m, k), what they change; the shapes of a cause share its variance.
        prior: Shape (k,), standard deviations of their sizes.
        probability: That they did, where it was as likely as not.
        mean, sigma: Sizes of the changes, averaged, and their standard deviations, in steps.
    """

    causes: tuple[tuple[Cause, ...], ...]
    columns: Array
    prior: Array
    probability: float
    mean: Array
    sigma: Array


def moved_along(background: Background, found: Found, terms: tuple[int, ...]) -> Along:
    """Return what may have moved along with the changes of an explanation, and their sizes beside it."""
    changes = [found.possible[i] for i in terms]
    named = {one.key for one in changes}
    mean, sigma = sizes_of(found, terms) if terms else (np.empty(0), np.empty(0))
    firsts = np.cumsum([0, *(len(one.prior) for one in changes)])[:-1]
    causes: list[tuple[Cause, ...]] = []
    columns, priors = [np.empty((len(background.white), 0))], [np.empty(0)]
    for change, first in zip(changes, firsts.tolist(), strict=True):
        entries = [one for one in _with(background.entries, change) if one.cause and one.cause.key not in named]
        shapes = Counter(one.cause.key for one in entries if one.cause)
        share = abs(float(mean[first] * _step(change.entry)[0]))
        for one in entries:
            assert one.cause
            columns.append(background.acting(one.columns, change.profile.weights))
            priors.append(share * _there(one) / np.sqrt(shapes[one.cause.key]))
        causes.append(tuple({one.cause.key: one.cause for one in entries if one.cause}.values()))
    along, prior = np.concatenate(columns, axis=1), np.concatenate(priors)
    if not len(prior):
        return Along(tuple(causes), along, prior, 0.0, mean, sigma)
    own = [background.acting(one.entry.columns, one.profile.weights) for one in changes]
    products = background.nuisances.products(background.white, np.concatenate([*own, along], axis=1))
    mine, others = np.split(np.arange(len(mean) + len(prior)), [len(mean)])
    own_prior = np.concatenate([one.prior for one in changes])
    probability = float(expit(products.given(mine, own_prior).log_evidence(others, prior)))
    beside, covariance = products.given(others, prior).sizes(mine, own_prior)
    both = (mean, beside), (sigma, np.sqrt(np.diag(covariance)))
    return Along(tuple(causes), along, prior, probability, *averaged(*both, probability))


def averaged(mean: tuple[Array, Array], sigma: tuple[Array, Array], probability: float) -> tuple[Array, Array]:
    """Return means and standard deviations, shape (k,) each, over two machines, of which the second has a probability.

    Args:
        mean: Of sizes, in either machine.
        sigma: Their standard deviations.
        probability: Of the second machine.
    """
    apart = mean[1] - mean[0]
    middle = mean[0] + probability * apart
    within = (1 - probability) * sigma[0] ** 2 + probability * sigma[1] ** 2
    return middle, np.sqrt(within + probability * (1 - probability) * apart**2)


def _with(entries: Sequence[Entry], change: Possible) -> list[Entry]:
    """Return what moves with a change, all its shapes."""
    own = change.entry.cause
    assert own
    return [
        one
        for one in entries
        if one.cause and one.cause.place == own.place and one.cause.effect.name in own.effect.moves_with
    ]


def _there(entry: Entry) -> Array:
    """Return how much there may be of what moves along, shape (k,), in steps."""
    assert entry.cause
    if entry.cause.effect.moves_with:  # a share of a level that the model has
        return np.asarray(1 / np.abs(_step(entry)), dtype=np.float64)
    return entry.what.plausible


def _step(entry: Entry) -> Array:
    assert isinstance(entry.what, Candidate)
    return entry.what.step
